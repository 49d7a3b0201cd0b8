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
