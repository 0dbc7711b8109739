# Debian 12 packages only (the `dev` script installs them). Nothing is downloaded and nothing is bundled.

find_package(TBB REQUIRED)
find_package(glm REQUIRED)
find_package(OpenEXR REQUIRED)
find_package(PNG REQUIRED)
find_package(nlohmann_json REQUIRED)
find_package(CLI11 REQUIRED)
find_package(fmt REQUIRED)
find_package(embree 4 QUIET)
if(NOT embree_FOUND)
  find_package(embree 3.13 REQUIRED)
endif()
find_package(libjpeg-turbo REQUIRED)
if(CANDELA_TESTS)
  # A second opinion on image files. SYSTEM so that its warnings stay its own.
  find_path(CANDELA_STB_INCLUDE stb_image.h PATH_SUFFIXES stb REQUIRED)
  add_library(candela_stb INTERFACE)
  target_include_directories(candela_stb SYSTEM INTERFACE ${CANDELA_STB_INCLUDE})

  # What runs the GLSL of src/shade.
  find_path(CANDELA_GLES_INCLUDE GLES3/gl3.h REQUIRED)
  find_library(CANDELA_EGL EGL REQUIRED)
  find_library(CANDELA_GLES GLESv2 REQUIRED)
  add_library(candela_gles INTERFACE)
  target_include_directories(candela_gles SYSTEM INTERFACE ${CANDELA_GLES_INCLUDE})
  target_link_libraries(candela_gles INTERFACE ${CANDELA_EGL} ${CANDELA_GLES})
endif()
find_program(CANDELA_GLSLANG glslangValidator REQUIRED)
