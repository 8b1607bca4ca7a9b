# Warnings of our own code. Third-party headers are included as SYSTEM.
add_library(gnomon_warnings INTERFACE)
target_compile_options(
    gnomon_warnings INTERFACE -Wall -Wextra -Wpedantic -Wshadow -Wnon-virtual-dtor -Wconversion
                              -Wno-sign-conversion -Wno-missing-field-initializers)
option(GNOMON_WERROR "Warnings are errors" OFF)
if(GNOMON_WERROR)
    target_compile_options(gnomon_warnings INTERFACE -Werror)
endif()
