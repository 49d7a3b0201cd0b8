# conus_embed_shaders(<target> <file>...): foo.frag.glsl becomes `const char shader_foo_frag[]` inside <target>, so that
# a shader is edited as a file and shipped inside the binary. Run as a script (cmake -DIN= -DOUT= -DNAME= -P) it writes
# that C file.
if(CMAKE_SCRIPT_MODE_FILE)
  file(READ "${IN}" hex HEX)
  string(REGEX REPLACE "([0-9a-f][0-9a-f])" "0x\\1," bytes "${hex}")
  file(WRITE "${OUT}" "#include \"render/gl/shaders.h\"\nconst char ${NAME}[] = {${bytes}0};\n")
  return()
endif()

function(conus_embed_shaders target)
  set(outputs "")
  foreach(path IN LISTS ARGN)
    get_filename_component(name "${path}" NAME)
    string(REGEX REPLACE "\\.glsl$" "" name "${name}")
    string(MAKE_C_IDENTIFIER "shader_${name}" symbol)
    set(out "${CMAKE_CURRENT_BINARY_DIR}/${symbol}.c")
    add_custom_command(OUTPUT "${out}"
      COMMAND "${CMAKE_COMMAND}" "-DIN=${CMAKE_CURRENT_SOURCE_DIR}/${path}" "-DOUT=${out}" "-DNAME=${symbol}"
              -P "${PROJECT_SOURCE_DIR}/cmake/embed.cmake"
      DEPENDS "${path}" "${PROJECT_SOURCE_DIR}/cmake/embed.cmake" VERBATIM)
    target_sources(${target} PRIVATE "${out}")
    list(APPEND outputs "${out}")
  endforeach()
  add_custom_target(${target}_shaders DEPENDS ${outputs}) # a rule reaches a target of another folder only this way
  add_dependencies(${target} ${target}_shaders)
endfunction()
