# Every target of the project is compiled with the same options; this file is the only place that knows them.

add_library(candela_options INTERFACE)
target_compile_features(candela_options INTERFACE cxx_std_20)
target_compile_options(candela_options INTERFACE -Wall -Wextra -Wpedantic -Wconversion -Wshadow -Wno-psabi)
# g++ 12 sees overlapping copies in "text" + std::string (GCC bug 105651).
target_compile_options(candela_options INTERFACE $<$<CXX_COMPILER_ID:GNU>:-Wno-restrict>)
if(CANDELA_WERROR)
  target_compile_options(candela_options INTERFACE -Werror)
endif()
if(EMSCRIPTEN)
  # Sizes have 32 bits there; what could be larger is checked where it is read, and new refuses what does not fit.
  target_compile_options(candela_options INTERFACE -Wno-shorten-64-to-32)
endif()
# A finite result is asserted everywhere, so NaN must stay NaN: no -ffast-math. Not setting errno only frees sqrt for inlining.
target_compile_options(candela_options INTERFACE -fno-math-errno -fno-trapping-math)
if(CANDELA_NATIVE)
  target_compile_options(candela_options INTERFACE -march=native)
elseif(CANDELA_X86_64_LEVEL GREATER 1 AND CMAKE_SYSTEM_PROCESSOR STREQUAL "x86_64")
  target_compile_options(candela_options INTERFACE -march=x86-64-v${CANDELA_X86_64_LEVEL})
endif()
if(CANDELA_SANITIZE)
  target_compile_options(candela_options INTERFACE -fsanitize=${CANDELA_SANITIZE} -fno-omit-frame-pointer -fno-sanitize-recover=all)
  target_link_options(candela_options INTERFACE -fsanitize=${CANDELA_SANITIZE})
endif()

# candela_library(NAME folder SOURCES a.cpp … LINKS public… PRIVATE third-party…)
# One static library per folder of src/. LINKS are other folders, PRIVATE are third-party targets that must not leak.
function(candela_library folder)
  cmake_parse_arguments(arg "" "" "SOURCES;LINKS;PRIVATE" ${ARGN})
  add_library(candela_${folder} STATIC ${arg_SOURCES})
  add_library(candela::${folder} ALIAS candela_${folder})
  set_target_properties(candela_${folder} PROPERTIES EXPORT_NAME ${folder})
  target_include_directories(candela_${folder} PUBLIC
    $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/src> $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}/candela>)
  target_link_libraries(candela_${folder} PUBLIC ${arg_LINKS} PRIVATE ${arg_PRIVATE} $<BUILD_INTERFACE:candela_options>)
  if(EMSCRIPTEN)
    # emscripten's compiler has no other cache, and reading these takes it most of its time.
    target_precompile_headers(candela_${folder} PRIVATE <algorithm> <filesystem> <functional> <map> <memory> <optional> <span> <string> <vector>
      <fmt/format.h> <glm/glm.hpp> <glm/gtc/quaternion.hpp>)
    if(nlohmann_json::nlohmann_json IN_LIST arg_PRIVATE)
      target_precompile_headers(candela_${folder} PRIVATE <nlohmann/json.hpp>)
    endif()
  endif()
  set_property(GLOBAL APPEND PROPERTY CANDELA_LIBRARIES candela_${folder})
endfunction()
