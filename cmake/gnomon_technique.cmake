# gnomon_technique(<name>)
#
# To be called in techniques/CMakeLists.txt: builds techniques/<name> with its shaders (every
# *.<stage>.glsl), adds its tests, and enters it into the registry, which calls gnomon::<name>_info().
function(gnomon_technique name)
    if(NOT EXISTS "${CMAKE_CURRENT_SOURCE_DIR}/${name}/README.md")
        message(FATAL_ERROR "techniques/${name} has no page: write techniques/${name}/README.md")
    endif()
    set_property(GLOBAL APPEND PROPERTY gnomon_techniques ${name})
    add_subdirectory(${name})
endfunction()
