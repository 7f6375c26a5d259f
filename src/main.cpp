// The `corotet` program: meshes, checks and runs soft bodies from the command line.
#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <corotet/detail/core/version.hpp>
#include <cstdio>
#include <exception>
#include <new>

#include "command.hpp"
#include "failure.hpp"

namespace {

using corotet::program::Command;

// 1: what was asked could not be done; 2: the command line was not understood.
constexpr int failed = 1, misused = 2;

int run(int argc, char** argv) {
  CLI::App app("corotet: soft bodies by corotational linear elasticity on tetrahedra", "corotet");
  app.set_version_flag("--version", fmt::format("corotet {}.{}.{}", COROTET_VERSION_MAJOR, COROTET_VERSION_MINOR,
                                                COROTET_VERSION_PATCH));
  app.require_subcommand(1);
  app.footer(
      "A first run, from nothing to frames that ParaView plays:\n"
      "  corotet mesh beam --order 2 -o beam.msh\n"
      "  corotet check beam.msh\n"
      "  echo '{\"mesh\": \"beam.msh\", \"pins\": [{\"box\": [[0, 0, 0], [0, 1, 1]]}],\n"
      "         \"frames\": {\"every\": 1}}' > scene.json\n"
      "  corotet run scene.json -o out\n\n"
      "`corotet COMMAND --help` tells more. Exit code: 0 if all that was asked was done, 1 if not, 2 for a command "
      "line\n"
      "that was not understood.");
  const Command commands[] = {corotet::program::add_mesh_command(app),   corotet::program::add_check_command(app),
                              corotet::program::add_run_command(app),    corotet::program::add_bench_command(app),
                              corotet::program::add_report_command(app), corotet::program::add_tune_command(app),
                              corotet::program::add_stress_command(app)};
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : misused;
  }
  for (const Command& command : commands)
    if (command.syntax->parsed()) return command.run();
  return misused;
}

/// What was printed may lie in a buffer until now, so that a full disk shows only here.
bool output_was_written() {
  const bool flushed = std::fflush(stdout) == 0;
  return flushed && std::ferror(stdout) == 0;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    const int code = run(argc, argv);
    if (output_was_written()) return code;
    fmt::print(stderr, "corotet: standard output could not be written\n");
  } catch (const corotet::program::Failure& failure) {
    fmt::print(stderr, "corotet: {}\n", failure.what());
  } catch (const std::bad_alloc&) {
    fmt::print(stderr, "corotet: there is not enough memory for this\n");
  } catch (const std::exception& error) {
    fmt::print(stderr, "corotet: {}\n", error.what());
  }
  return failed;
}
