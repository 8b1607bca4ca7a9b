# Warnings of our own code. Third-party headers are included as SYSTEM.
add_library(gnomon_warnings INTERFACE)
target_compile_options(
    gnomon_warnings INTERFACE -Wall -Wextra -Wpedantic -Wshadow -Wnon-virtual-dtor -Wconversion
                              -Wno-sign-conversion -Wno-missing-field-initializers)
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 13)
    # GCC 12 sees these in std::string's and std::optional's own inlined code at -O3.
    target_compile_options(gnomon_warnings INTERFACE -Wno-maybe-uninitialized -Wno-restrict
                                                     -Wno-array-bounds)
endif()
option(GNOMON_WERROR "Warnings are errors" OFF)
if(GNOMON_WERROR)
    target_compile_options(gnomon_warnings INTERFACE -Werror)
endif()
