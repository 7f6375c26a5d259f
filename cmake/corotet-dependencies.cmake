# How corotet looks up what it depends on; used in the source tree and, installed, by corotet-config.cmake.
# Each function leaves in `problem` an empty string, or a sentence that says what is missing.

# find_package makes targets that are seen only in the directory that called it and below. A project that adds corotet as
# a subdirectory links from above, so in the source tree `corotet_scope` is GLOBAL; installed, it is empty.
function(corotet_make_visible target)
  if(corotet_scope STREQUAL "GLOBAL")
    set_target_properties(${target} PROPERTIES IMPORTED_GLOBAL TRUE)
  endif()
endfunction()

function(corotet_find_eigen problem)
  set(${problem} "" PARENT_SCOPE)
  if(TARGET Eigen3::Eigen)
    return()  # the surrounding project brought its own
  endif()
  # No version is asked for: the package of Eigen 5 is also called Eigen3, and says that it is not compatible with 3.4.
  find_package(Eigen3 CONFIG QUIET)
  if(NOT Eigen3_FOUND)
    set(${problem} "Eigen 3.4 or newer is needed, and CMake finds no package Eigen3 (Debian: libeigen3-dev). \
If it lies in an unusual place, set Eigen3_DIR to the folder of its Eigen3Config.cmake." PARENT_SCOPE)
  elseif(Eigen3_VERSION VERSION_LESS 3.4)
    set(${problem} "Eigen 3.4 or newer is needed, but ${Eigen3_DIR} is version ${Eigen3_VERSION}. Set Eigen3_DIR to \
the folder of a newer Eigen3Config.cmake." PARENT_SCOPE)
  else()
    corotet_make_visible(Eigen3::Eigen)
  endif()
endfunction()

# Makes corotet::<component>, which links corotet::corotet and the library behind the component.
function(corotet_add_component component problem)
  set(${problem} "" PARENT_SCOPE)
  if(TARGET corotet::${component})
    return()
  endif()
  if(component STREQUAL "tbb")
    set(library TBB::tbb)
    set(package TBB)
    set(hint "oneTBB is not found (Debian: libtbb-dev)")
  elseif(component STREQUAL "cholmod")
    set(library SuiteSparse::CHOLMOD)
    set(package CHOLMOD)
    set(hint "SuiteSparse's CHOLMOD is not found (Debian: libsuitesparse-dev)")
  else()
    set(${problem} "corotet has no component '${component}' (it has: tbb, cholmod)" PARENT_SCOPE)
    return()
  endif()
  if(NOT TARGET ${library})
    find_package(${package} QUIET)
    if(NOT TARGET ${library})
      set(${problem} "${hint}" PARENT_SCOPE)
      return()
    endif()
    corotet_make_visible(${library})
  endif()
  add_library(corotet::${component} INTERFACE IMPORTED ${corotet_scope})
  target_link_libraries(corotet::${component} INTERFACE corotet::corotet ${library})
endfunction()
