# Language level, warnings, sanitizers, ccache and output folders for the whole tree.
option(VISMEM_WERROR "Treat warnings as errors" OFF)
set(VISMEM_SANITIZE "" CACHE STRING "Value of -fsanitize=, empty for none")
option(VISMEM_LIBUSB "Build the drivers that need libusb-1.0" ON)
# Headers of Ice and Eigen are most of what a file costs. Files that are compiled together share their cost, so names that a file
# keeps for itself must differ within a library.
option(VISMEM_UNITY "Compile the files of a library eight at a time" OFF)
option(VISMEM_FUZZ "Build libFuzzer targets (needs clang)" OFF)

set(CMAKE_CXX_STANDARD 20)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_POSITION_INDEPENDENT_CODE ON)
set(CMAKE_RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/bin)

# Release binaries keep assertions out and run on any CPU of the architecture: no -march flags here.
set(CMAKE_CXX_FLAGS_RELEASE "-O2 -DNDEBUG")

# Addresses of library functions are resolved at start and read-only from then on.
add_link_options(-Wl,-z,relro,-z,now)

# For the libraries of a folder that only pass data on, over Ice for the most part: at -O1 they build a fifth faster.
macro(vismem_light_optimization)
  add_compile_options($<$<CONFIG:Release>:-O1>)
endmacro()

# For the libraries of a folder that handle each image: inlines more, also functions with external names. The results have the same bytes.
macro(vismem_full_optimization)
  add_compile_options($<$<CONFIG:Release>:-O3> -fno-math-errno -fno-semantic-interposition)
endmacro()

find_program(VISMEM_CCACHE ccache)
if(VISMEM_CCACHE)
  # Relative paths let checkouts in different folders share one cache.
  set(CMAKE_CXX_COMPILER_LAUNCHER
      ${CMAKE_COMMAND} -E env CCACHE_BASEDIR=${CMAKE_SOURCE_DIR} CCACHE_NOHASHDIR=1 ${VISMEM_CCACHE})
  set(CMAKE_C_COMPILER_LAUNCHER ${CMAKE_CXX_COMPILER_LAUNCHER})
endif()

# Sanitizer builds keep assertions, and line numbers for their reports; more optimisation or more symbols
# would double the time they take to build.
set(CMAKE_CXX_FLAGS_RELWITHDEBINFO "-O1 -g1")
if(VISMEM_SANITIZE)
  add_compile_options(-fsanitize=${VISMEM_SANITIZE} -fno-omit-frame-pointer -fno-sanitize-recover=all)
  add_link_options(-fsanitize=${VISMEM_SANITIZE})
endif()
if(VISMEM_FUZZ)
  add_compile_options(-fsanitize=fuzzer-no-link)
endif()

add_library(project_warnings INTERFACE)
target_compile_options(project_warnings INTERFACE -Wall -Wextra -Wshadow -Wnon-virtual-dtor
                                                  -Woverloaded-virtual)
if(VISMEM_WERROR)
  target_compile_options(project_warnings INTERFACE -Werror)
endif()
