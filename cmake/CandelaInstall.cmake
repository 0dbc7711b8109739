# `cmake --install` gives the program, the library and find_package(candela).

get_property(candela_libraries GLOBAL PROPERTY CANDELA_LIBRARIES)
install(TARGETS candela_cli RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
# Desktops show pictures of models in their file managers (freedesktop.org's thumbnailers).
install(FILES ${PROJECT_SOURCE_DIR}/share/candela.thumbnailer DESTINATION ${CMAKE_INSTALL_DATADIR}/thumbnailers)
install(TARGETS ${candela_libraries} EXPORT candelaTargets
  ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR})
install(DIRECTORY ${PROJECT_SOURCE_DIR}/src/ DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/candela FILES_MATCHING PATTERN "*.h")
install(EXPORT candelaTargets NAMESPACE candela:: DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/candela)

include(CMakePackageConfigHelpers)
configure_package_config_file(${CMAKE_CURRENT_LIST_DIR}/candelaConfig.cmake.in ${PROJECT_BINARY_DIR}/candelaConfig.cmake
  INSTALL_DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/candela)
write_basic_package_version_file(${PROJECT_BINARY_DIR}/candelaConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/candelaConfig.cmake ${PROJECT_BINARY_DIR}/candelaConfigVersion.cmake
  DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/candela)
