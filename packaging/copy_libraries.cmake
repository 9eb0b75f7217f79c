# Copies what `programs` and `modules` load to lib/cw2, where they look for it, and the licence of
# each; and the `font` of the panel.
file(GET_RUNTIME_DEPENDENCIES
    EXECUTABLES ${programs} MODULES ${modules}
    RESOLVED_DEPENDENCIES_VAR libraries
    PRE_EXCLUDE_REGEXES "^ld-linux" "^lib(c|m|dl|rt|pthread|resolv|util|gcc_s|stdc\\+\\+)\\.so")
set(prefix ${CMAKE_INSTALL_PREFIX})
file(INSTALL ${libraries} DESTINATION ${prefix}/lib/cw2 FOLLOW_SYMLINK_CHAIN)
if(EXISTS "${font}")
    file(INSTALL ${font} DESTINATION ${prefix}/share/cw2)
endif()
foreach(path IN LISTS libraries font)
    file(REAL_PATH ${path} path)
    # Some packages still say /lib for /usr/lib.
    string(REGEX REPLACE "^/usr" "*" pattern ${path})
    execute_process(COMMAND dpkg-query -S ${pattern} OUTPUT_VARIABLE owner ERROR_QUIET)
    if(owner MATCHES "^([^:]+):")
        file(INSTALL /usr/share/doc/${CMAKE_MATCH_1}/copyright
            DESTINATION ${prefix}/share/doc/cw2/licenses RENAME ${CMAKE_MATCH_1})
    else()
        message(WARNING "The licence of ${path} is not known: add it to share/doc/cw2/licenses")
    endif()
endforeach()
