# gnomon_shaders(<target>)
#
# Compiles each entry point of the folder (*.vert.glsl, *.tesc.glsl, *.tese.glsl, *.frag.glsl, *.comp.glsl) and makes it an array of
# SPIR-V words in <name.stage.spv.h>:
#     namespace gnomon::shaders { inline constexpr std::uint32_t name_stage[] = {...}; }
# To be called in the folder of <target>, because CMake sees custom commands only there.
function(gnomon_shaders target)
    file(GLOB sources CONFIGURE_DEPENDS RELATIVE "${CMAKE_CURRENT_SOURCE_DIR}" "*.vert.glsl"
         "*.tesc.glsl" "*.tese.glsl" "*.frag.glsl" "*.comp.glsl")
    set(out "${CMAKE_CURRENT_BINARY_DIR}/shaders")
    file(MAKE_DIRECTORY "${out}")  # glslc can fail to write into a missing folder and still exit 0
    set(headers)
    foreach(source IN LISTS sources)
        string(REGEX REPLACE "\\.glsl$" "" entry "${source}")
        string(REGEX REPLACE "^.*\\." "" stage "${entry}")
        string(REPLACE "." "_" symbol "${entry}")
        set(words "${out}/${entry}.inc")
        add_custom_command(
            OUTPUT "${words}"
            COMMAND
                "${GLSLC}" -fshader-stage=${stage} --target-env=vulkan1.3 -O -Werror -mfmt=num
                -I "${PROJECT_SOURCE_DIR}/src" -MD -MF "${words}.d" -o "${words}"
                "${CMAKE_CURRENT_SOURCE_DIR}/${source}"
            DEPENDS "${source}"
            DEPFILE "${words}.d"
            VERBATIM)
        file(
            CONFIGURE
            OUTPUT "${out}/${entry}.spv.h"
            CONTENT "#pragma once\n\n#include <cstdint>\n\nnamespace gnomon::shaders {\n\
inline constexpr std::uint32_t ${symbol}[] = {\n#include \"${entry}.inc\"\n};\n}\n")
        list(APPEND headers "${words}")
    endforeach()
    add_custom_target(${target}_shaders DEPENDS ${headers})
    add_dependencies(${target} ${target}_shaders)
    target_include_directories(${target} PRIVATE "${out}")
endfunction()
