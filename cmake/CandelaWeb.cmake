# The libraries of a build for browsers, in place of those of CandelaDependencies.cmake: tools/web_libraries.sh has compiled them into
# CMAKE_FIND_ROOT_PATH. Headers that are all of a library come from the system's packages.

find_package(Python3 COMPONENTS Interpreter REQUIRED)
find_package(fmt REQUIRED)
find_package(OpenEXR REQUIRED)
find_package(PNG REQUIRED)
find_library(CANDELA_DRACO draco REQUIRED)
find_path(CANDELA_TURBOJPEG_INCLUDE turbojpeg.h REQUIRED)
find_library(CANDELA_TURBOJPEG turbojpeg REQUIRED)
find_path(CANDELA_WEBP_INCLUDE webp/decode.h REQUIRED)
find_library(CANDELA_WEBP webp REQUIRED)
find_library(CANDELA_WEBP_DEMUX webpdemux REQUIRED)
find_library(CANDELA_WEBP_MUX webpmux REQUIRED)
find_path(CANDELA_ZIP_INCLUDE zip.h REQUIRED)
find_library(CANDELA_ZIP zip REQUIRED)
find_package(ZLIB REQUIRED)
find_package(zstd REQUIRED)
find_program(CANDELA_GLSLANG glslangValidator REQUIRED)
list(APPEND CANDELA_ZIP ZLIB::ZLIB)

# /usr/include as a whole would hide the C library of browsers, so that a folder refers to what is needed of it. The header
# charconv stands before the C++ library's, which does not read decimal numbers.
set(candela_system_headers ${PROJECT_BINARY_DIR}/system-headers)
file(MAKE_DIRECTORY ${candela_system_headers})
foreach(library glm nlohmann)
  find_path(CANDELA_WEB_${library} ${library} PATHS /usr/include /usr/local/include NO_DEFAULT_PATH NO_CMAKE_FIND_ROOT_PATH REQUIRED)
  file(CREATE_LINK ${CANDELA_WEB_${library}}/${library} ${candela_system_headers}/${library} SYMBOLIC)
endforeach()
get_target_property(candela_fmt_headers fmt::fmt INTERFACE_INCLUDE_DIRECTORIES)
include_directories(SYSTEM ${PROJECT_SOURCE_DIR}/web/module/headers ${candela_system_headers} ${candela_fmt_headers})

# The names that the folders of src/ know: static libraries where those are shared ones, nothing for what a browser has itself or goes
# without (docs/web.md).
function(candela_stand_in name)
  if(NOT TARGET ${name})
    add_library(${name} INTERFACE IMPORTED GLOBAL)
  endif()
  target_link_libraries(${name} INTERFACE ${ARGN})
endfunction()
candela_stand_in(glm::glm)
candela_stand_in(nlohmann_json::nlohmann_json)
candela_stand_in(TBB::tbb)
candela_stand_in(avif)
candela_stand_in(astcenc::astcenc)
candela_stand_in(draco::draco ${CANDELA_DRACO})
candela_stand_in(libjpeg-turbo::turbojpeg ${CANDELA_TURBOJPEG})
candela_stand_in(zstd::libzstd_shared zstd::libzstd_static)
set(CANDELA_EGL "")
set(CANDELA_GLES "")

# Every object of a program has to agree on how exceptions and longjmp() work; tools/web_libraries.sh has the same line.
add_compile_options(-fwasm-exceptions -sSUPPORT_LONGJMP=wasm -msimd128)
add_link_options(-fwasm-exceptions -sSUPPORT_LONGJMP=wasm)
