# Shared by the scripts; sourced by them, not run.
# shellcheck shell=bash

root=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
jobs=$(getconf _NPROCESSORS_ONLN 2>/dev/null || echo 2)

say() { printf '\n== %s\n' "$*"; }
die() {
  printf '%s: %s\n' "$(basename "$0")" "$*" >&2
  exit 1
}

# What is needed, for what, and its package in Debian 12, Fedora, Arch and Homebrew (- : none, or part of another).
#   demo  the library and its first example                run   the program and all examples
#   gpl   the examples that link GPL libraries
#   test  the tests, sanitizers, fuzzing and linting       port  other compilers, systems and processors
#   docs  the reference of the API
packages() {
  cat <<'TABLE'
demo g++                gcc-c++                 gcc             -
demo cmake              cmake                   cmake           cmake
demo ninja-build        ninja-build             ninja           ninja
run  libeigen3-dev      eigen3-devel            eigen           eigen
run  libcli11-dev       cli11-devel             cli11           cli11
run  nlohmann-json3-dev json-devel              nlohmann-json   nlohmann-json
run  libfmt-dev         fmt-devel               fmt             fmt
gpl  libgmsh-dev        gmsh-devel              gmsh            gmsh
gpl  libcgal-dev        CGAL-devel              cgal            cgal
test libgtest-dev       gtest-devel             gtest           googletest
test libbenchmark-dev   google-benchmark-devel  benchmark       google-benchmark
test libtbb-dev         tbb-devel               onetbb          tbb
test libsuitesparse-dev suitesparse-devel       suitesparse     suite-sparse
test python3            python3                 python          python
test gmsh               gmsh                    gmsh            gmsh
test tetgen             tetgen                  -               -
test calculix-ccx       -                       -               -
test clang-16           clang                   clang           llvm
test libclang-rt-16-dev compiler-rt             compiler-rt     -
test clang-tidy-16      clang-tools-extra       -               -
test clang-format-16    clang-tools-extra       -               -
test shellcheck         ShellCheck              shellcheck      shellcheck
test codespell          codespell               codespell       codespell
docs doxygen            doxygen                 doxygen         doxygen
docs python3            python3                 python          python
port clang-16           clang                   clang           llvm
port libc++-16-dev      libcxx-devel            libc++          -
port libc++abi-16-dev   libcxxabi-devel         libc++abi       -
port libfast-float-dev  fast_float-devel        fast_float      fast_float
port g++-mingw-w64-x86-64-posix mingw64-gcc-c++ mingw-w64-gcc   mingw-w64
port wine64             wine                    wine            -
port g++-aarch64-linux-gnu gcc-c++-aarch64-linux-gnu aarch64-linux-gnu-gcc -
port qemu-user          qemu-user               qemu-user       -
port lld-16             lld                     lld             lld
port wasi-libc          wasi-libc-devel         wasi-libc       wasi-libc
port libc++-16-dev-wasm32 wasi-libcxx           wasi-libc++     -
port libc++abi-16-dev-wasm32 wasi-libcxxabi     wasi-libc++abi  -
port libclang-rt-16-dev-wasm32 -                wasi-compiler-rt -
port nodejs             nodejs                  nodejs          node
port libx11-dev         libX11-devel            libx11          -
port python3-pip        python3-pip             python-pip      -
TABLE
}

# package_names COLUMN GROUP...: the names in that column of the table, each once.
package_names() {
  local column=$1 group
  shift
  for group in "$@"; do
    packages | awk -v group="$group" -v column="$column" '$1 == group && $column != "-" { print $column }'
  done | awk '!seen[$0]++'
}

is_installed() { [ "$(dpkg-query -W -f='${db:Status-Status}' "$1" 2>/dev/null)" = installed ]; }

# install_missing GROUP...: installs by apt what is missing of these groups, and says what. Without apt it prints the
# names and goes on: CMake then says what it does not find.
install_missing() {
  local wanted missing=() name as_root=()
  if ! command -v apt-get >/dev/null || ! command -v dpkg-query >/dev/null; then
    say "There is no apt here, so nothing is installed. These are needed (the scripts are tested on Debian 12 only):"
    echo "  Debian:   $(package_names 2 "$@" | xargs)"
    echo "  Fedora:   $(package_names 3 "$@" | xargs)"
    echo "  Arch:     $(package_names 4 "$@" | xargs)"
    echo "  Homebrew: $(package_names 5 "$@" | xargs)"
    return
  fi
  set -- demo "$@" # which the others need, too
  mapfile -t wanted < <(package_names 2 "$@")
  for name in "${wanted[@]}"; do
    is_installed "$name" || missing+=("$name")
  done
  if [ ${#missing[@]} -eq 0 ]; then
    echo "All ${#wanted[@]} packages needed are installed."
    return
  fi
  say "Installing by apt: ${missing[*]}"
  if [ "$(id -u)" -ne 0 ]; then
    command -v sudo >/dev/null ||
      die "root is needed once, to run: apt-get install --no-install-recommends ${missing[*]}"
    as_root=(sudo)
  fi
  # Lists that are new enough need no update; old or missing ones make the first try fail.
  local install=("${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends)
  if ! "${install[@]}" "${missing[@]}" >/dev/null 2>&1; then
    "${as_root[@]}" apt-get update -qq || die "apt-get update failed: is there a network?"
    "${install[@]}" "${missing[@]}" >/dev/null ||
      die "apt could not install: ${missing[*]} (Debian 12 has all of them)"
  fi
}

# ON where the script installed gmsh and CGAL itself; elsewhere their examples are left out unless asked for.
default_gpl() { if command -v apt-get >/dev/null; then echo ON; else echo OFF; fi; }

# Configures PRESET into build/PRESET, with further options for CMake.
configure() {
  local preset=$1
  shift
  local launcher=()
  if command -v ccache >/dev/null; then
    export CCACHE_SLOPPINESS=pch_defines,time_macros,include_file_mtime,include_file_ctime
    launcher=(-DCMAKE_CXX_COMPILER_LAUNCHER=ccache)
  fi
  (cd "$root" && cmake --preset "$preset" "${launcher[@]}" "$@")
}

# Builds build/PRESET; lists the files only where someone watches.
build() {
  local preset=$1 quiet=()
  shift
  [ -t 1 ] || quiet=(-- --quiet)
  cmake --build "$root/build/$preset" -j "$jobs" "$@" "${quiet[@]}"
}
