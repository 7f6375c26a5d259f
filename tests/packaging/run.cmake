# Runs one packaging test: cmake -DCASE=... -DSOURCE=... -DWORK=... -DGENERATOR=... -DCOMPILER=... -DVERSION=... -P run.cmake
cmake_policy(VERSION 3.22)

set(prefix ${WORK}/prefix)
set(consumer ${CMAKE_CURRENT_LIST_DIR}/consumer)
set(build ${WORK}/${CASE})
file(REMOVE_RECURSE ${build})

# Runs a command; sets `output`; fails the test if the command fails (or, after EXPECT_FAILURE, if it succeeds).
function(run)
  cmake_parse_arguments(PARSE_ARGV 0 arg "EXPECT_FAILURE" "" "COMMAND")
  execute_process(COMMAND ${arg_COMMAND} RESULT_VARIABLE status OUTPUT_VARIABLE text ERROR_VARIABLE text)
  list(JOIN arg_COMMAND " " line)
  if(arg_EXPECT_FAILURE AND status EQUAL 0)
    message(FATAL_ERROR "This should have failed: ${line}\n${text}")
  elseif(NOT arg_EXPECT_FAILURE AND NOT status EQUAL 0)
    message(FATAL_ERROR "This failed (${status}): ${line}\n${text}")
  endif()
  set(output "${text}" PARENT_SCOPE)
endfunction()

set(configure ${CMAKE_COMMAND} -G ${GENERATOR} -DCMAKE_CXX_COMPILER=${COMPILER} -DCMAKE_BUILD_TYPE=Debug
              -DCMAKE_CXX_FLAGS_DEBUG=-O0)
set(from_package ${configure} -DCONSUME=package -DCMAKE_PREFIX_PATH=${prefix}
                 -DCMAKE_FIND_USE_PACKAGE_REGISTRY=OFF)

function(build_and_run)
  run(COMMAND ${CMAKE_COMMAND} --build ${build})
  run(COMMAND ${build}/consumer)
  if(NOT output MATCHES "corotet ${VERSION}")
    message(FATAL_ERROR "The consumer did not report version ${VERSION}: ${output}")
  endif()
endfunction()

function(expect_output pattern)
  string(REGEX REPLACE "[ \n]+" " " flat "${output}")  # CMake wraps its messages
  if(NOT flat MATCHES "${pattern}")
    message(FATAL_ERROR "Expected to read '${pattern}' in:\n${output}")
  endif()
endfunction()

# An Eigen of another version: its package files, around the real headers.
function(make_fake_eigen version)
  file(WRITE ${build}-eigen/Eigen3Config.cmake "add_library(Eigen3::Eigen INTERFACE IMPORTED)
find_path(eigen_headers Eigen/Core PATH_SUFFIXES eigen3 REQUIRED)
target_include_directories(Eigen3::Eigen INTERFACE \${eigen_headers})\n")
  # As Eigen's own: compatible with requests for the same major version only.
  string(REGEX MATCH "^[0-9]+" major ${version})
  file(WRITE ${build}-eigen/Eigen3ConfigVersion.cmake "set(PACKAGE_VERSION ${version})
if(PACKAGE_FIND_VERSION_MAJOR STREQUAL ${major})\n  set(PACKAGE_VERSION_COMPATIBLE TRUE)\nendif()\n")
endfunction()

if(CASE STREQUAL "install")
  file(REMOVE_RECURSE ${prefix})
  run(COMMAND ${configure} -S ${SOURCE} -B ${build} -DCMAKE_INSTALL_PREFIX=${prefix})
  run(COMMAND ${CMAKE_COMMAND} --build ${build})
  run(COMMAND ${CMAKE_COMMAND} --install ${build})
  file(GLOB_RECURSE ours RELATIVE ${SOURCE}/include ${SOURCE}/include/corotet/*.hpp)
  file(GLOB_RECURSE theirs RELATIVE ${prefix}/include ${prefix}/include/*)
  if(NOT ours OR NOT ours STREQUAL theirs)
    message(FATAL_ERROR "The installed headers differ from the source's:\n${theirs}\n${ours}")
  endif()
  file(GLOB_RECURSE license ${prefix}/LICENSE)
  file(GLOB_RECURSE package_files ${prefix}/*.cmake)
  if(NOT license OR NOT package_files)
    message(FATAL_ERROR "The license or the CMake package is not installed")
  endif()
  # The prefix can be moved or packed: no installed file names a folder of this machine.
  foreach(file IN LISTS package_files)
    file(READ ${file} text)
    foreach(folder IN ITEMS ${SOURCE} ${prefix} ${build})
      string(FIND "${text}" "${folder}" at)
      if(NOT at EQUAL -1)
        message(FATAL_ERROR "${file} names ${folder}")
      endif()
    endforeach()
  endforeach()

elseif(CASE STREQUAL "package")
  run(COMMAND ${from_package} -S ${consumer} -B ${build})
  build_and_run()

elseif(CASE STREQUAL "package_opt_in")
  run(COMMAND ${from_package} -S ${consumer} -B ${build} "-DOPT_IN=eigen;tbb;cholmod")
  build_and_run()

elseif(CASE STREQUAL "compiled")  # installed with the compiled library, in a prefix of its own; debug builds link it
  run(COMMAND ${configure} -S ${SOURCE} -B ${build}-library -DCMAKE_INSTALL_PREFIX=${prefix}-compiled
              -DCOROTET_WITH_COMPILED=ON)
  run(COMMAND ${CMAKE_COMMAND} --build ${build}-library --parallel 2)
  run(COMMAND ${CMAKE_COMMAND} --install ${build}-library)
  run(COMMAND ${configure} -DCONSUME=package -DCMAKE_PREFIX_PATH=${prefix}-compiled
              -DCMAKE_FIND_USE_PACKAGE_REGISTRY=OFF -S ${consumer} -B ${build} -DOPT_IN=compiled)
  build_and_run()

elseif(CASE STREQUAL "subdirectory" OR CASE STREQUAL "fetchcontent")
  run(COMMAND ${configure} -S ${consumer} -B ${build} -DCONSUME=${CASE} -DCOROTET_SOURCE=${SOURCE})
  build_and_run()
  run(COMMAND ${CMAKE_COMMAND} --install ${build} --prefix ${build}/installed)
  if(EXISTS ${build}/installed)
    message(FATAL_ERROR "corotet installed files with a project that only uses it")
  endif()

elseif(CASE STREQUAL "subdirectory_opt_in")
  run(COMMAND ${configure} -S ${consumer} -B ${build} -DCONSUME=subdirectory -DCOROTET_SOURCE=${SOURCE}
              "-DOPT_IN=eigen;tbb;cholmod" -DCOROTET_WITH_EIGEN=ON -DCOROTET_WITH_TBB=ON -DCOROTET_WITH_CHOLMOD=ON)
  build_and_run()

elseif(CASE STREQUAL "version")
  string(REGEX MATCH "^([0-9]+)\\.([0-9]+)" major_minor ${VERSION})
  math(EXPR next_major "${CMAKE_MATCH_1} + 1")
  math(EXPR next_minor "${CMAKE_MATCH_2} + 1")
  run(COMMAND ${from_package} -S ${consumer} -B ${build} -DWANTED_VERSION=${VERSION})
  foreach(unlike IN ITEMS ${next_major}.0 ${CMAKE_MATCH_1}.${next_minor})
    run(EXPECT_FAILURE COMMAND ${from_package} -S ${consumer} -B ${build}-${unlike} -DWANTED_VERSION=${unlike})
    expect_output("version: ${VERSION}")
  endforeach()

elseif(CASE STREQUAL "components")
  run(EXPECT_FAILURE COMMAND ${from_package} -S ${consumer} -B ${build} -DOPT_IN=pardiso)
  expect_output("has no component 'pardiso'")
  run(EXPECT_FAILURE COMMAND ${from_package} -S ${consumer} -B ${build}-missing -DOPT_IN=tbb
                             -DCMAKE_DISABLE_FIND_PACKAGE_TBB=ON)
  expect_output("oneTBB is not found")
  run(EXPECT_FAILURE COMMAND ${from_package} -S ${consumer} -B ${build}-compiled -DOPT_IN=compiled)
  expect_output("without corotet::compiled")

elseif(CASE STREQUAL "old_eigen")
  make_fake_eigen(3.3.9)
  run(EXPECT_FAILURE COMMAND ${from_package} -S ${consumer} -B ${build} -DOPT_IN=eigen -DEigen3_DIR=${build}-eigen)
  expect_output("Eigen 3.4 or newer is needed, but .* is version 3.3.9")

elseif(CASE STREQUAL "old_eigen_in_tree")
  make_fake_eigen(3.3.9)
  run(EXPECT_FAILURE COMMAND ${configure} -S ${consumer} -B ${build} -DCONSUME=subdirectory -DCOROTET_SOURCE=${SOURCE}
                             -DOPT_IN=eigen -DCOROTET_WITH_EIGEN=ON -DEigen3_DIR=${build}-eigen)
  expect_output("Eigen 3.4 or newer is needed, but .* is version 3.3.9")

elseif(CASE STREQUAL "eigen5")
  make_fake_eigen(5.0.1)
  run(COMMAND ${from_package} -S ${consumer} -B ${build} -DOPT_IN=eigen -DEigen3_DIR=${build}-eigen)
  run(COMMAND ${configure} -S ${consumer} -B ${build}-in-tree -DCONSUME=subdirectory -DCOROTET_SOURCE=${SOURCE}
              -DOPT_IN=eigen -DCOROTET_WITH_EIGEN=ON -DEigen3_DIR=${build}-eigen)

else()
  message(FATAL_ERROR "There is no packaging test '${CASE}'")
endif()
