# Read by ctest before it runs tests. None of them touches the folders of whoever runs them.
set(ENV{HOME} @PROJECT_BINARY_DIR@/home)
file(MAKE_DIRECTORY $ENV{HOME})
# Where Mesa keeps compiled shaders, also for tests with folders of their own; it does not ask HOME.
set(ENV{MESA_SHADER_CACHE_DIR} $ENV{HOME}/shaders)
# Mesa compiles a shader in less time without optimising it; what it draws is small.
set(ENV{GALLIVM_PERF} nopt)
# Mesa draws in the thread that asks: CTest keeps all processors busy, and handing over a small picture takes longer than it.
set(ENV{LP_NUM_THREADS} 0)
foreach(folder IN ITEMS CACHE CONFIG DATA STATE)
  unset(ENV{XDG_${folder}_HOME})
endforeach()
