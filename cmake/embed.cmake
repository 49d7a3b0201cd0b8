# conus_embed_shaders(<target> <file>...): foo.frag.glsl becomes `const char shader_foo_frag[]` inside <target>, so that
# a shader is edited as a file and shipped inside the binary. conus_embed_font(<target> <file>): `const unsigned char
# font_sans[]`, of font_sans_size, packed by gzip. Run as a script (cmake -DIN= -DOUT= -DHEADER= -DNAME= -DTYPE= -P) it
# writes that C file.
if(CMAKE_SCRIPT_MODE_FILE)
  file(READ "${IN}" hex HEX)
  if(IN MATCHES "\\.gz$") # whose time is none
    string(REGEX REPLACE "^(1f8b....)........" "\\100000000" hex "${hex}")
  endif()
  string(REGEX REPLACE "([0-9a-f][0-9a-f])" "0x\\1," bytes "${hex}")
  set(size "")
  if(NOT TYPE STREQUAL "char") # text ends with its 0
    set(size "const size_t ${NAME}_size = sizeof ${NAME} - 1;\n")
  endif()
  file(WRITE "${OUT}" "#include \"${HEADER}\"\nconst ${TYPE} ${NAME}[] = {${bytes}0};\n${size}")
  return()
endif()

function(conus_embed target path header type symbol)
  set(out "${CMAKE_CURRENT_BINARY_DIR}/${symbol}.c")
  add_custom_command(OUTPUT "${out}"
    COMMAND "${CMAKE_COMMAND}" "-DIN=${path}" "-DOUT=${out}" "-DHEADER=${header}" "-DNAME=${symbol}" "-DTYPE=${type}"
            -P "${PROJECT_SOURCE_DIR}/cmake/embed.cmake"
    DEPENDS "${path}" "${PROJECT_SOURCE_DIR}/cmake/embed.cmake" VERBATIM)
  target_sources(${target} PRIVATE "${out}")
  add_custom_target(${target}_${symbol} DEPENDS "${out}") # a rule reaches a target of another folder only this way
  add_dependencies(${target} ${target}_${symbol})
endfunction()

function(conus_embed_shaders target)
  foreach(path IN LISTS ARGN)
    get_filename_component(name "${path}" NAME)
    string(REGEX REPLACE "\\.glsl$" "" name "${name}")
    string(MAKE_C_IDENTIFIER "shader_${name}" symbol)
    conus_embed(${target} "${CMAKE_CURRENT_SOURCE_DIR}/${path}" render/gl/gl.h char ${symbol})
  endforeach()
endfunction()

# Liberation 1, which some systems have in that place, has a licence that a program with it would have to take.
function(conus_embed_font target path)
  if(EXISTS "${path}")
    file(STRINGS "${path}" licence REGEX "SIL Open Font License")
  endif()
  if(NOT licence)
    message(FATAL_ERROR "CONUS_FONT: ${path}, needed is LiberationSans-Regular.ttf of version 2 (Debian: fonts-liberation2)")
  endif()
  set(packed "${CMAKE_CURRENT_BINARY_DIR}/font.gz")
  file(ARCHIVE_CREATE OUTPUT "${packed}" PATHS "${path}" FORMAT raw COMPRESSION GZip COMPRESSION_LEVEL 9)
  conus_embed(${target} "${packed}" render/draw/draw.h "unsigned char" font_sans)
endfunction()
