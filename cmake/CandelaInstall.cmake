# `cmake --install` gives the program, the library and find_package(candela): the components `program` and `development`.

set(CANDELA_ZSH_COMPLETION ${CMAKE_INSTALL_DATADIR}/zsh/site-functions CACHE STRING "Where zsh looks for functions of programs")

install(TARGETS candela_cli RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT program)
# Desktops show pictures of models in their file managers (freedesktop.org's thumbnailers).
install(FILES ${PROJECT_SOURCE_DIR}/share/candela.thumbnailer DESTINATION ${CMAKE_INSTALL_DATADIR}/thumbnailers COMPONENT program)
install(FILES ${PROJECT_SOURCE_DIR}/share/completion/candela.bash DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions
  RENAME candela COMPONENT program)
install(FILES ${PROJECT_SOURCE_DIR}/share/completion/candela.zsh DESTINATION ${CANDELA_ZSH_COMPLETION} RENAME _candela COMPONENT program)
install(FILES ${PROJECT_SOURCE_DIR}/README.md DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT program)
install(DIRECTORY ${PROJECT_SOURCE_DIR}/examples/farm DESTINATION ${CMAKE_INSTALL_DOCDIR}/examples COMPONENT program USE_SOURCE_PERMISSIONS)

# The manual is made by the program from its own table of options.
set(candela_manual ${PROJECT_BINARY_DIR}/man1)
add_custom_command(OUTPUT ${candela_manual}/candela.1
  COMMAND ${CMAKE_COMMAND} -E rm -rf ${candela_manual}
  COMMAND candela_cli completion man -o ${candela_manual}
  DEPENDS candela_cli COMMENT "Writing the manual" VERBATIM)
add_custom_target(candela_manual ALL DEPENDS ${candela_manual}/candela.1)
install(DIRECTORY ${candela_manual} DESTINATION ${CMAKE_INSTALL_MANDIR} COMPONENT program)

get_property(candela_libraries GLOBAL PROPERTY CANDELA_LIBRARIES)
install(TARGETS ${candela_libraries} EXPORT candelaTargets
  ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT development LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT development)
install(DIRECTORY ${PROJECT_SOURCE_DIR}/src/ DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/candela COMPONENT development FILES_MATCHING PATTERN "*.h")
install(EXPORT candelaTargets NAMESPACE candela:: DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/candela COMPONENT development)

include(CMakePackageConfigHelpers)
configure_package_config_file(${CMAKE_CURRENT_LIST_DIR}/candelaConfig.cmake.in ${PROJECT_BINARY_DIR}/candelaConfig.cmake
  INSTALL_DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/candela)
write_basic_package_version_file(${PROJECT_BINARY_DIR}/candelaConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/candelaConfig.cmake ${PROJECT_BINARY_DIR}/candelaConfigVersion.cmake
  DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/candela COMPONENT development)
