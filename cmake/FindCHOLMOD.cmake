# Finds SuiteSparse's CHOLMOD and makes SuiteSparse::CHOLMOD, the name that SuiteSparse 7's own CMake package uses.
# Older installations and Debian 12 have no such package; there the header and the library are searched for.
#
# Results: CHOLMOD_FOUND, CHOLMOD_VERSION, SuiteSparse::CHOLMOD.
# Hints: CHOLMOD_INCLUDE_DIR, CHOLMOD_LIBRARY.
include(FindPackageHandleStandardArgs)

find_package(CHOLMOD CONFIG QUIET)
if(CHOLMOD_FOUND)
  if(NOT TARGET SuiteSparse::CHOLMOD AND TARGET SuiteSparse::CHOLMOD_static)
    add_library(SuiteSparse::CHOLMOD INTERFACE IMPORTED)
    target_link_libraries(SuiteSparse::CHOLMOD INTERFACE SuiteSparse::CHOLMOD_static)
  endif()
  find_package_handle_standard_args(CHOLMOD CONFIG_MODE)
  return()
endif()

find_path(CHOLMOD_INCLUDE_DIR cholmod.h PATH_SUFFIXES suitesparse)
find_library(CHOLMOD_LIBRARY cholmod)
mark_as_advanced(CHOLMOD_INCLUDE_DIR CHOLMOD_LIBRARY)

if(EXISTS "${CHOLMOD_INCLUDE_DIR}/cholmod.h")
  # CHOLMOD 5 moved nothing here: the three numbers stand in cholmod.h, in older releases in cholmod_core.h.
  foreach(header IN ITEMS cholmod.h cholmod_core.h)
    if(NOT CHOLMOD_VERSION AND EXISTS "${CHOLMOD_INCLUDE_DIR}/${header}")
      file(STRINGS "${CHOLMOD_INCLUDE_DIR}/${header}" lines
           REGEX "^#define CHOLMOD_(MAIN|SUB|SUBSUB)_VERSION +[0-9]+")
      string(REGEX REPLACE "[^0-9;]" "" numbers "${lines}")
      list(JOIN numbers "." CHOLMOD_VERSION)
    endif()
  endforeach()
endif()

find_package_handle_standard_args(CHOLMOD REQUIRED_VARS CHOLMOD_LIBRARY CHOLMOD_INCLUDE_DIR
                                  VERSION_VAR CHOLMOD_VERSION)
if(CHOLMOD_FOUND AND NOT TARGET SuiteSparse::CHOLMOD)
  add_library(SuiteSparse::CHOLMOD UNKNOWN IMPORTED)
  set_target_properties(SuiteSparse::CHOLMOD PROPERTIES IMPORTED_LOCATION "${CHOLMOD_LIBRARY}"
                                                        INTERFACE_INCLUDE_DIRECTORIES "${CHOLMOD_INCLUDE_DIR}")
endif()
