# Sets VTK_FOUND and makes VTK's targets for the peers of conus-bench, in the directory that includes this: each one that links
# conus_peers.
if(CMAKE_CXX_COMPILER)
  find_package(VTK 9.1 QUIET COMPONENTS CommonCore CommonDataModel CommonMath RenderingCore RenderingOpenGL2 RenderingVolume
    RenderingVolumeOpenGL2)
endif()
