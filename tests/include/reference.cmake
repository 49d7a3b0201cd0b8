# cmake -DROOT=<source folder> -DOUTPUT=<folder> -DDOXYGEN=<program> -P reference.cmake
# Runs doxygen with docs/Doxyfile. It fails on a warning: a function, parameter, result or member without a description.
if(NOT DOXYGEN)
  message("reference: skipped, there is no doxygen")
  return()
endif()
file(READ ${ROOT}/docs/Doxyfile settings)
file(WRITE ${OUTPUT}/Doxyfile "${settings}\nOUTPUT_DIRECTORY = ${OUTPUT}/reference\n")
file(MAKE_DIRECTORY ${OUTPUT}/reference)
execute_process(COMMAND ${DOXYGEN} ${OUTPUT}/Doxyfile WORKING_DIRECTORY ${ROOT} COMMAND_ERROR_IS_FATAL ANY)

# Doxygen does not ask for these: each function says since when it is there, and who may call it.
file(GLOB headers ${ROOT}/include/conus/*.h)
foreach(header IN LISTS headers)
  file(READ ${header} text)
  string(REPLACE ";" "," text "${text}") # a semicolon would split CMake's list
  string(REGEX MATCHALL "\n(CONUS_API|CONUS_CHECKED) " functions "${text}")
  string(REGEX MATCHALL
    " \\* @threads [^\n]+\n \\* @since [0-9]+\\.[0-9]+\n \\*/\n(CONUS_API|CONUS_CHECKED) " described "${text}")
  list(LENGTH functions wanted)
  list(LENGTH described found)
  if(NOT wanted EQUAL found)
    message(FATAL_ERROR "${header}: ${found} of ${wanted} functions end their description with @threads and @since")
  endif()
endforeach()
