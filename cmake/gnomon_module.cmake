# gnomon_module(<name> [DEPENDS module...] [LIBRARIES package...])
#
# All .cpp of a folder of src/ or techniques/ as the object library gnomon_<name>, which may include only
# the modules that it names. <file>_test.cpp beside them become the test program <name>_test.
function(gnomon_module name)
    cmake_parse_arguments(arg "" "" "DEPENDS;LIBRARIES" ${ARGN})
    file(GLOB sources CONFIGURE_DEPENDS "${CMAKE_CURRENT_SOURCE_DIR}/*.cpp")
    list(FILTER sources EXCLUDE REGEX "_test\\.cpp$")
    add_library(gnomon_${name} OBJECT ${sources})
    target_include_directories(gnomon_${name} PUBLIC "${PROJECT_SOURCE_DIR}/include"
                                                     "${PROJECT_SOURCE_DIR}/src")
    target_link_libraries(gnomon_${name} PUBLIC glm::glm fmt::fmt ${arg_LIBRARIES})
    target_link_libraries(gnomon_${name} PRIVATE gnomon_warnings)

    set(closure gnomon_${name})
    foreach(dependency IN LISTS arg_DEPENDS)
        get_property(below GLOBAL PROPERTY gnomon_closure_${dependency})
        list(APPEND closure ${below})
        target_link_libraries(gnomon_${name} PUBLIC gnomon_${dependency})
    endforeach()
    list(REMOVE_DUPLICATES closure)
    set_property(GLOBAL PROPERTY gnomon_closure_${name} "${closure}")
    set_property(GLOBAL APPEND PROPERTY gnomon_modules gnomon_${name})
    gnomon_module_tests(${name})
endfunction()

# What every test program is linked with. Most of them are compiled longer than they run: -O1 takes a
# quarter less. The library is under test as it is shipped.
if(GNOMON_TESTS)
    add_library(gnomon_gtest INTERFACE)
    target_link_libraries(gnomon_gtest INTERFACE GTest::gtest GTest::gtest_main gnomon_warnings)
    target_compile_options(gnomon_gtest INTERFACE $<$<CONFIG:Release>:-O1>)
endif()

# The test program of a folder, linked with the module of that name and all below it.
function(gnomon_module_tests name)
    file(GLOB tests CONFIGURE_DEPENDS "${CMAKE_CURRENT_SOURCE_DIR}/*_test.cpp")
    if(NOT GNOMON_TESTS OR NOT tests)
        return()
    endif()
    get_property(closure GLOBAL PROPERTY gnomon_closure_${name})
    if("gnomon_technique" IN_LIST closure)
        list(APPEND closure gnomon)  # for the registry, which calls into every technique
    endif()
    add_executable(${name}_test ${tests})
    target_link_libraries(${name}_test PRIVATE ${closure} gnomon_gtest)
    add_test(NAME ${name} COMMAND ${name}_test)
    set_tests_properties(${name} PROPERTIES WORKING_DIRECTORY "${CMAKE_CURRENT_BINARY_DIR}")
endfunction()
