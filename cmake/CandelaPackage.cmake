# `./dev package`: two packages for Debian by `cpack -G DEB`, candela and libcandela-dev, of the components in CandelaInstall.cmake.
# What only a package has lies in build/package/debian and belongs to the components as well.

set(CANDELA_DEBIAN_REVISION "" CACHE STRING "What follows the version of a Debian package, e.g. 1~deb12; empty = not to be packaged")
if(NOT CANDELA_DEBIAN_REVISION)
  return()
endif()
foreach(variable CANDELA_MAINTAINER CANDELA_DEBIAN_RELEASE)
  if(NOT ${variable})
    message(FATAL_ERROR "-D${variable}= is missing; ./dev package gives it")
  endif()
endforeach()

set(package_program candela)
set(package_development libcandela-dev)

# The papers that Debian wants of each. The time is SOURCE_DATE_EPOCH's, so that equal sources give equal bytes.
set(papers ${PROJECT_BINARY_DIR}/debian)
set(revised ${PROJECT_VERSION}-${CANDELA_DEBIAN_REVISION})
string(TIMESTAMP date "%a, %d %b %Y %H:%M:%S +0000" UTC)
string(TIMESTAMP year "%Y" UTC)
find_program(CANDELA_GZIP gzip REQUIRED)
foreach(component program development)
  set(package ${package_${component}})
  set(folder ${papers}/${package})
  file(MAKE_DIRECTORY ${folder})
  configure_file(${PROJECT_SOURCE_DIR}/share/debian/copyright.in ${folder}/copyright @ONLY)
  configure_file(${PROJECT_SOURCE_DIR}/share/debian/changelog.in ${folder}/changelog.Debian @ONLY)
  configure_file(${PROJECT_SOURCE_DIR}/CHANGELOG.md ${folder}/changelog COPYONLY)
  execute_process(COMMAND ${CANDELA_GZIP} -9 -n -f ${folder}/changelog ${folder}/changelog.Debian COMMAND_ERROR_IS_FATAL ANY)
  install(FILES ${folder}/copyright ${folder}/changelog.gz ${folder}/changelog.Debian.gz
    DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/${package} COMPONENT ${component})
endforeach()
install(FILES ${PROJECT_SOURCE_DIR}/share/debian/libcandela-dev.overrides DESTINATION ${CMAKE_INSTALL_DATADIR}/lintian/overrides
  RENAME libcandela-dev COMPONENT development)
# Debian's manual is compressed.
install(CODE "
  file(GLOB pages \"\$ENV{DESTDIR}\${CMAKE_INSTALL_PREFIX}/${CMAKE_INSTALL_MANDIR}/man1/*.1\")
  execute_process(COMMAND ${CANDELA_GZIP} -9 -n -f \${pages} COMMAND_ERROR_IS_FATAL ANY)" COMPONENT program)

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_DIRECTORY ${PROJECT_BINARY_DIR})
set(CPACK_PACKAGE_CONTACT ${CANDELA_MAINTAINER})
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "") # each component has its own, else CPack prepends this one
set(CPACK_STRIP_FILES ON)
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)
set(CPACK_COMPONENTS_ALL program development)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_RELEASE ${CANDELA_DEBIAN_REVISION})
set(CPACK_DEBIAN_PACKAGE_PRIORITY optional)
set(CPACK_DEBIAN_COMPRESSION_TYPE xz)

set(CPACK_DEBIAN_PROGRAM_PACKAGE_NAME ${package_program})
set(CPACK_DEBIAN_PROGRAM_PACKAGE_SECTION graphics)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_SHLIBDEPS ON)
# What is looked for when it is wanted: a driver that draws without a GPU, films, windows.
set(CPACK_DEBIAN_PROGRAM_PACKAGE_RECOMMENDS "libgl1-mesa-dri")
set(CPACK_DEBIAN_PROGRAM_PACKAGE_SUGGESTS "ffmpeg, libglfw3, man-db, bash-completion")
set(CPACK_COMPONENT_PROGRAM_DESCRIPTION "physically based renderer for glTF
Candela renders glTF scenes with physically based light: a path tracer for
reference images, an OpenGL renderer for real time, both of one material
source. It bakes image-based light for engines, checks assets, compares
pictures, and needs neither a GPU nor a display.")

set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_NAME ${package_development})
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_SECTION libdevel)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_SUGGESTS "candela")
# What find_package(candela) looks for, and what its static libraries are linked with.
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_DEPENDS "libassimp-dev, libastcenc-dev, libavif-dev, libdraco-dev, libegl-dev, libembree-dev, libfmt-dev, \
libfreetype-dev, libgles-dev, libglm-dev, libjpeg62-turbo-dev, libopenexr-dev, libpng-dev, libtbb-dev, libturbojpeg0-dev, libwebp-dev, libzip-dev, \
libzstd-dev, nlohmann-json3-dev, zlib1g-dev")
set(CPACK_COMPONENT_DEVELOPMENT_DESCRIPTION "physically based renderer for glTF - library
Candela renders glTF scenes with physically based light. This package has its
static C++20 libraries, their headers, and what find_package(candela) of CMake
needs.")
include(CPack)
