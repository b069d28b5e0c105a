# What `cmake --install build/release --prefix FOLDER` puts into FOLDER: the command, and the C++ client with what it takes to build
# programs against it, through find_package(curvecast) or pkg-config. With --component command or client only one of these;
# proto has the .proto files alone, which client has too. The folder may be moved afterwards.
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)
set(package_folder ${CMAKE_INSTALL_LIBDIR}/cmake/curvecast)
set(pkg_config_folder ${CMAKE_INSTALL_LIBDIR}/pkgconfig)

install(TARGETS curvecast RUNTIME COMPONENT command)
foreach(component command client)
  install(FILES ${PROJECT_SOURCE_DIR}/LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT ${component})
endforeach()

# curvecast_tls is there because the client is linked to it; it has no headers for others.
install(TARGETS curvecast_client curvecast_tls EXPORT curvecast COMPONENT client
  INCLUDES DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}
  PUBLIC_HEADER DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/curvecast/client COMPONENT client)
install(TARGETS curvecast_proto EXPORT curvecast COMPONENT client
  INCLUDES DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}
  PUBLIC_HEADER DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/curvecast/v1 COMPONENT client)
# Where protoc finds them by the path by which they import each other.
foreach(component client proto)
  install(DIRECTORY ${PROJECT_SOURCE_DIR}/proto/curvecast DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} COMPONENT ${component}
    FILES_MATCHING PATTERN *.proto)
endforeach()

install(EXPORT curvecast NAMESPACE curvecast:: FILE curvecastTargets.cmake DESTINATION ${package_folder} COMPONENT client)
configure_package_config_file(${CMAKE_CURRENT_LIST_DIR}/curvecastConfig.cmake.in ${PROJECT_BINARY_DIR}/curvecastConfig.cmake
  INSTALL_DESTINATION ${package_folder} PATH_VARS CMAKE_INSTALL_INCLUDEDIR NO_CHECK_REQUIRED_COMPONENTS_MACRO)
write_basic_package_version_file(${PROJECT_BINARY_DIR}/curvecastConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/curvecastConfig.cmake ${PROJECT_BINARY_DIR}/curvecastConfigVersion.cmake
  DESTINATION ${package_folder} COMPONENT client)

# From the folder of the .pc file to the prefix, which is known only when it is installed.
cmake_path(RELATIVE_PATH CMAKE_INSTALL_PREFIX BASE_DIRECTORY ${CMAKE_INSTALL_PREFIX}/${pkg_config_folder}
  OUTPUT_VARIABLE up_to_prefix)
configure_file(${CMAKE_CURRENT_LIST_DIR}/curvecast-client.pc.in ${PROJECT_BINARY_DIR}/curvecast-client.pc @ONLY)
install(FILES ${PROJECT_BINARY_DIR}/curvecast-client.pc DESTINATION ${pkg_config_folder} COMPONENT client)
