# FindERFA: the imported target ERFA::ERFA. Debian's package brings no file of its own for CMake.
find_path(ERFA_INCLUDE_DIR erfa.h)
find_library(ERFA_LIBRARY erfa)
mark_as_advanced(ERFA_INCLUDE_DIR ERFA_LIBRARY)

include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(ERFA REQUIRED_VARS ERFA_LIBRARY ERFA_INCLUDE_DIR)
if(ERFA_FOUND AND NOT TARGET ERFA::ERFA)
    add_library(ERFA::ERFA UNKNOWN IMPORTED)
    set_target_properties(ERFA::ERFA PROPERTIES IMPORTED_LOCATION "${ERFA_LIBRARY}"
                                                INTERFACE_INCLUDE_DIRECTORIES "${ERFA_INCLUDE_DIR}")
endif()
