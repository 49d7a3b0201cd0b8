# Read by ctest before it runs tests. None of them touches the folders of whoever runs them, nor their cache; those of the cache
# have their own.
set(ENV{CONUS_CACHE} off)
set(ENV{HOME} @PROJECT_BINARY_DIR@/home)
file(MAKE_DIRECTORY $ENV{HOME})
foreach(folder IN ITEMS CACHE CONFIG DATA STATE)
  unset(ENV{XDG_${folder}_HOME})
endforeach()
