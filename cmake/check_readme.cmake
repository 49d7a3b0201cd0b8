cmake_minimum_required(VERSION 3.25)
# cmake -DROOT=<source folder> -P check_readme.cmake
# The files that the README links to exist, and it has fewer than 120 lines.
file(READ "${ROOT}/README.md" readme)
string(REGEX REPLACE "[^\n]" "" ends "${readme}")
string(LENGTH "${ends}" lines)
if(lines GREATER_EQUAL 120)
  message(FATAL_ERROR "README.md: ${lines} lines, fewer than 120 are allowed")
endif()
string(REPLACE "](" "LINK(" readme "${readme}") # a bracket alone would spoil CMake's list
string(REGEX MATCHALL "LINK\\([a-zA-Z][^):#]*" links "${readme}")
foreach(link IN LISTS links)
  string(SUBSTRING "${link}" 5 -1 path)
  if(NOT EXISTS "${ROOT}/${path}")
    message(FATAL_ERROR "README.md: links to ${path}, which is not there")
  endif()
endforeach()
