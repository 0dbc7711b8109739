cmake_minimum_required(VERSION 3.25)
# cmake -DINPUT=shade/x.glsl.h -DROOT=src -DOUTPUT=x.frag -P FlattenGlsl.cmake
# Writes a fragment shader (GLSL ES 3.00) that holds the header with every include expanded once, and an empty main().

set(flatten_seen "")
set(flatten_text "#version 300 es\nprecision highp float;\nprecision highp int;\n")

function(flatten file)
  if(file IN_LIST flatten_seen)
    return()
  endif()
  list(APPEND flatten_seen ${file})
  file(STRINGS ${ROOT}/${file} lines)
  file(READ ${ROOT}/${file} text)
  foreach(line IN LISTS lines)
    if(line MATCHES "^#include \"(.*)\"")
      set(include_line "${line}")
      set(included ${CMAKE_MATCH_1})
      flatten(${included})
      string(REPLACE "${include_line}" "" text "${text}")
    endif()
  endforeach()
  string(APPEND flatten_text "// ---- ${file}\n${text}")
  set(flatten_seen "${flatten_seen}" PARENT_SCOPE)
  set(flatten_text "${flatten_text}" PARENT_SCOPE)
endfunction()

flatten(${INPUT})
file(WRITE ${OUTPUT} "${flatten_text}\nout vec4 color;\nvoid main() { color = vec4(0.0f); }\n")
