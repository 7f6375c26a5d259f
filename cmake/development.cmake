# For our own programs, tests, examples and benchmarks only: nothing here reaches a user of the library.
option(COROTET_WARNINGS_AS_ERRORS "Turn compiler warnings in our own code into errors" OFF)

add_library(corotet_warnings INTERFACE)
if(CMAKE_CXX_COMPILER_ID MATCHES "GNU|Clang")
  target_compile_options(corotet_warnings INTERFACE -Wall -Wextra -Wpedantic -Wconversion -Wshadow
                                                    $<$<BOOL:${COROTET_WARNINGS_AS_ERRORS}>:-Werror>)
endif()

# The library promises to work without exceptions and RTTI, so its tests are compiled without them.
add_library(corotet_no_exceptions INTERFACE)
if(CMAKE_CXX_COMPILER_ID MATCHES "GNU|Clang")
  target_compile_options(corotet_no_exceptions INTERFACE -fno-exceptions -fno-rtti)
endif()

set(CMAKE_EXPORT_COMPILE_COMMANDS ON)

# The yardstick of the program and of the benchmarks, the same code in both: see its header.
add_library(corotet_plain_product OBJECT EXCLUDE_FROM_ALL ${PROJECT_SOURCE_DIR}/src/plain_product.cpp)
target_link_libraries(corotet_plain_product PRIVATE corotet::corotet corotet_warnings)
target_compile_options(corotet_plain_product PRIVATE -fno-tree-vectorize -fno-tree-slp-vectorize)
