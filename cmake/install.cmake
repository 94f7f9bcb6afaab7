# Installs the library and its headers so that another CMake project finds phyxel::phyxel by find_package(phyxel).
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

set(config_folder ${CMAKE_INSTALL_LIBDIR}/cmake/phyxel)
install(TARGETS phyxel phyxel_dependencies EXPORT phyxelTargets)
install(DIRECTORY include/phyxel DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
install(EXPORT phyxelTargets NAMESPACE phyxel:: DESTINATION ${config_folder})
configure_package_config_file(cmake/phyxelConfig.cmake.in ${CMAKE_BINARY_DIR}/phyxelConfig.cmake INSTALL_DESTINATION ${config_folder})
write_basic_package_version_file(${CMAKE_BINARY_DIR}/phyxelConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_BINARY_DIR}/phyxelConfig.cmake ${CMAKE_BINARY_DIR}/phyxelConfigVersion.cmake DESTINATION ${config_folder})

if(TARGET phyxel_cli)
  set_target_properties(phyxel_cli PROPERTIES INSTALL_RPATH "$ORIGIN/../${CMAKE_INSTALL_LIBDIR}")
  install(TARGETS phyxel_cli)
endif()
