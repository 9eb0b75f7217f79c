# cw2_bake(TARGET SOURCES a.obj b.glb ... [OPTIONS --compress ...])
#
# Adds a target, part of `all`, that bakes each source into a.cw2mesh, b.cw2mesh ... of
# CMAKE_CURRENT_BINARY_DIR, with these options of cw2-bake. A source is baked anew when it, a file
# that it names, an option, or cw2-bake changes, and only then.
cmake_policy(VERSION 3.25)

function(cw2_bake target)
    cmake_parse_arguments(PARSE_ARGV 1 bake "" "" "SOURCES;OPTIONS")
    if(NOT bake_SOURCES OR DEFINED bake_UNPARSED_ARGUMENTS)
        message(FATAL_ERROR "usage: cw2_bake(TARGET SOURCES a.obj b.glb ... [OPTIONS ...])")
    endif()
    if(TARGET cw2-bake)
        set(program cw2-bake)
    else()
        # This file lies in PREFIX/lib/cmake/cw2, or one folder deeper.
        set(here ${CMAKE_CURRENT_FUNCTION_LIST_DIR})
        find_program(CW2_BAKE cw2-bake HINTS ${here}/../../../bin ${here}/../../../../bin REQUIRED)
        set(program ${CW2_BAKE})
    endif()
    set(outputs)
    foreach(source IN LISTS bake_SOURCES)
        cmake_path(ABSOLUTE_PATH source BASE_DIRECTORY ${CMAKE_CURRENT_SOURCE_DIR} NORMALIZE)
        cmake_path(GET source STEM LAST_ONLY name)
        set(output ${CMAKE_CURRENT_BINARY_DIR}/${name}.cw2mesh)
        if(output IN_LIST outputs)
            message(FATAL_ERROR "cw2_bake: two sources would become ${output}")
        endif()
        list(APPEND outputs ${output})
        add_custom_command(
            OUTPUT ${output}
            COMMAND ${program} ${source} -o ${output} --depfile ${output}.d --quiet ${bake_OPTIONS}
            DEPENDS ${source} ${program}
            DEPFILE ${output}.d
            COMMENT "Baking ${name}.cw2mesh"
            VERBATIM)
    endforeach()
    add_custom_target(${target} ALL DEPENDS ${outputs})
endfunction()
