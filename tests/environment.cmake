# Read by ctest before it runs tests: none of them touches the cache of whoever runs them. Those of the cache have their
# own.
set(ENV{CONUS_CACHE} off)
