# The places in which `cmake --install` puts files. Components: runtime (programs, shared library, man pages,
# completions, files for the desktop), devel (headers, static library, conus.pc, CMake's configuration), doc (documents
# and examples).
include(CMakePackageConfigHelpers)

# Libraries
install(TARGETS conus EXPORT conus-targets LIBRARY COMPONENT runtime NAMELINK_COMPONENT devel RUNTIME COMPONENT runtime
  ARCHIVE COMPONENT devel INCLUDES DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
install(TARGETS conus_static EXPORT conus-static-targets COMPONENT devel INCLUDES DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
install(DIRECTORY include/conus DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} COMPONENT devel FILES_MATCHING PATTERN "*.h"
  PATTERN "own.h" EXCLUDE)

set(config_folder ${CMAKE_INSTALL_LIBDIR}/cmake/conus)
install(EXPORT conus-targets NAMESPACE conus:: DESTINATION ${config_folder} COMPONENT devel)
install(EXPORT conus-static-targets NAMESPACE conus:: DESTINATION ${config_folder} COMPONENT devel)
configure_package_config_file(cmake/conus-config.cmake.in conus-config.cmake INSTALL_DESTINATION ${config_folder})
write_basic_package_version_file(conus-config-version.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/conus-config.cmake ${PROJECT_BINARY_DIR}/conus-config-version.cmake
  DESTINATION ${config_folder} COMPONENT devel)

# conus.pc finds itself, so that an installed tree may be moved.
file(RELATIVE_PATH CONUS_PC_TO_PREFIX /${CMAKE_INSTALL_LIBDIR}/pkgconfig /)
string(REGEX REPLACE "/$" "" CONUS_PC_TO_PREFIX "${CONUS_PC_TO_PREFIX}")
configure_file(cmake/conus.pc.in conus.pc @ONLY)
install(FILES ${PROJECT_BINARY_DIR}/conus.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig COMPONENT devel)

# Programs
# What is made of the tables of options of each: man pages and completions.
find_program(CONUS_PAGES_PYTHON python3)
if(NOT CONUS_PAGES_PYTHON)
  message(STATUS "man pages, completions and descriptors are left out: there is no python3")
endif()
foreach(program IN ITEMS conus_cli conus-view conus-mesh conus-hdf5)
  if(NOT TARGET ${program})
    continue()
  endif()
  install(TARGETS ${program} COMPONENT runtime)
  if(program MATCHES "mesh|hdf5" OR CMAKE_CROSSCOMPILING OR NOT CONUS_PAGES_PYTHON) # started by conus, no commands for people; or does not run here
    continue()
  endif()
  set(name $<TARGET_FILE_BASE_NAME:${program}>)
  set(pages ${PROJECT_BINARY_DIR}/pages/${program})
  add_custom_command(OUTPUT ${pages}.written
    COMMAND ${CMAKE_COMMAND} -E env CONUS=$<TARGET_FILE:${program}> ${CONUS_PAGES_PYTHON} ${PROJECT_SOURCE_DIR}/scripts/pages ${pages}
    COMMAND ${CMAKE_COMMAND} -E touch ${pages}.written
    DEPENDS ${program} scripts/pages COMMENT "Writing the pages of ${program}" VERBATIM)
  add_custom_target(${program}_pages ALL DEPENDS ${pages}.written)
  install(DIRECTORY ${pages}/ DESTINATION ${CMAKE_INSTALL_MANDIR}/man1 COMPONENT runtime FILES_MATCHING PATTERN "*.1")
  install(FILES ${pages}/${name}.bash DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions RENAME ${name}
    COMPONENT runtime)
  install(FILES ${pages}/${name}.fish DESTINATION ${CMAKE_INSTALL_DATADIR}/fish/vendor_completions.d COMPONENT runtime)
  install(FILES ${pages}/_${name} DESTINATION ${CMAKE_INSTALL_DATADIR}/zsh/site-functions COMPONENT runtime)
endforeach()
file(MAKE_DIRECTORY ${PROJECT_BINARY_DIR}/pages)

# Desktop
if(TARGET conus-view)
  set(desktop packaging/desktop)
  install(FILES ${desktop}/conus-view.desktop DESTINATION ${CMAKE_INSTALL_DATADIR}/applications COMPONENT runtime)
  install(FILES ${desktop}/conus-view.metainfo.xml DESTINATION ${CMAKE_INSTALL_DATADIR}/metainfo COMPONENT runtime)
  install(FILES ${desktop}/conus-mime.xml DESTINATION ${CMAKE_INSTALL_DATADIR}/mime/packages RENAME conus.xml COMPONENT runtime)
  install(FILES ${desktop}/conus-view.svg DESTINATION ${CMAKE_INSTALL_DATADIR}/icons/hicolor/scalable/apps COMPONENT runtime)
endif()

# MATLAB and Octave
install(FILES packaging/matlab/conus.m DESTINATION ${CMAKE_INSTALL_DATADIR}/conus/matlab COMPONENT runtime)

# 3D Slicer and Boutiques
if(CONUS_PAGES_PYTHON AND TARGET conus_cli AND NOT CMAKE_CROSSCOMPILING)
  set(descriptors ${PROJECT_BINARY_DIR}/descriptors)
  add_custom_command(OUTPUT ${descriptors}.written
    COMMAND ${CMAKE_COMMAND} -E env CONUS=$<TARGET_FILE:conus_cli> ${CONUS_PAGES_PYTHON} ${PROJECT_SOURCE_DIR}/scripts/descriptors ${descriptors}
    COMMAND ${CMAKE_COMMAND} -E touch ${descriptors}.written
    DEPENDS conus_cli scripts/descriptors COMMENT "Writing what Slicer and Boutiques read" VERBATIM)
  add_custom_target(conus_descriptors ALL DEPENDS ${descriptors}.written)
  install(DIRECTORY ${descriptors}/ DESTINATION ${CMAKE_INSTALL_DATADIR}/conus COMPONENT runtime USE_SOURCE_PERMISSIONS)
endif()

# Documents
install(FILES LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT runtime)
install(FILES README.md CHANGELOG.md SECURITY.md DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT doc)
install(DIRECTORY docs/ DESTINATION ${CMAKE_INSTALL_DOCDIR}/docs COMPONENT doc PATTERN Doxyfile EXCLUDE PATTERN "site.*" EXCLUDE)
install(DIRECTORY examples/ DESTINATION ${CMAKE_INSTALL_DOCDIR}/examples COMPONENT doc FILES_MATCHING PATTERN "*.c" PATTERN "*.py")

# Away again
if(PROJECT_IS_TOP_LEVEL)
  add_custom_target(uninstall COMMAND ${CMAKE_COMMAND} -DBUILD=${PROJECT_BINARY_DIR} -P ${PROJECT_SOURCE_DIR}/cmake/uninstall.cmake
    COMMENT "Removing what was installed" VERBATIM)
endif()
