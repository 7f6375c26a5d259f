# The CMake package: headers, corotet::corotet, corotet::compiled, and the recipes for the opt-in components.
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

if(COROTET_WITH_COMPILED)
  set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/corotet)
  set(arch_independent "")
  install(TARGETS corotet_compiled EXPORT corotet-targets ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR})
else()
  set(package_dir ${CMAKE_INSTALL_DATADIR}/cmake/corotet)  # share/: nothing in it depends on the machine
  set(arch_independent ARCH_INDEPENDENT)
endif()

# An absolute CMAKE_INSTALL_INCLUDEDIR is allowed, so the path must not be put behind the prefix here.
target_include_directories(corotet INTERFACE $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
install(TARGETS corotet EXPORT corotet-targets)
install(EXPORT corotet-targets NAMESPACE corotet:: DESTINATION ${package_dir})
install(DIRECTORY include/corotet DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} FILES_MATCHING PATTERN "*.hpp")
install(FILES LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR})

configure_package_config_file(cmake/corotet-config.cmake.in ${CMAKE_CURRENT_BINARY_DIR}/corotet-config.cmake
                              INSTALL_DESTINATION ${package_dir})
# Before 1.0 a minor version may change the interface.
if(PROJECT_VERSION_MAJOR EQUAL 0)
  set(compatibility SameMinorVersion)
else()
  set(compatibility SameMajorVersion)
endif()
write_basic_package_version_file(${CMAKE_CURRENT_BINARY_DIR}/corotet-config-version.cmake
                                 COMPATIBILITY ${compatibility} ${arch_independent})
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/corotet-config.cmake
              ${CMAKE_CURRENT_BINARY_DIR}/corotet-config-version.cmake
              cmake/corotet-dependencies.cmake
              cmake/FindCHOLMOD.cmake
        DESTINATION ${package_dir})
