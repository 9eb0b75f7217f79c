# The archive runs where nothing else is installed: it holds the libraries that the programs load,
# except those that a driver of Vulkan shares with them and that every Linux has, and a font.
# Where the programs look for libraries; those look there, too, since this is RPATH, not RUNPATH.
# From the start: CMake would leave room for it by colons, each of which is the current folder.
set_target_properties(cw2 cw2-bake PROPERTIES
    INSTALL_RPATH $ORIGIN/../lib/cw2
    BUILD_WITH_INSTALL_RPATH ON)
target_link_options(cw2 PRIVATE -Wl,--disable-new-dtags)
target_link_options(cw2-bake PRIVATE -Wl,--disable-new-dtags)
find_file(panel_font DejaVuSans.ttf
    PATHS /usr/share/fonts/truetype/dejavu /usr/share/fonts/dejavu-sans-fonts /usr/share/fonts/TTF)
mark_as_advanced(panel_font)
install(CODE "
set(programs $<TARGET_FILE:cw2> $<TARGET_FILE:cw2-bake>)
set(modules $<TARGET_FILE:draco_reader>)
set(font ${panel_font})
" COMPONENT archive EXCLUDE_FROM_ALL)
install(SCRIPT copy_libraries.cmake COMPONENT archive EXCLUDE_FROM_ALL)
