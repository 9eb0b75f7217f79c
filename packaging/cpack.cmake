# One Debian package for each of `packages`, COMPONENT:NAME; one archive of the programs and of the
# libraries that they need.
set(CPACK_PACKAGE_NAME cw2)
set(CPACK_PACKAGE_VENDOR "cw2")
# Whoever hands packages on answers for them. RFC 2606 keeps .invalid free of addresses.
set(CW2_MAINTAINER "cw2 maintainers <maintainers@cw2.invalid>" CACHE STRING
    "maintainer that Debian packages name: NAME <ADDRESS>")
set(CPACK_PACKAGE_CONTACT ${CW2_MAINTAINER})
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "baker and Vulkan renderer of triangle meshes")
set(CPACK_RESOURCE_FILE_LICENSE ${PROJECT_SOURCE_DIR}/LICENSE)
set(CPACK_PACKAGE_DIRECTORY ${PROJECT_BINARY_DIR}/packages)
set(CPACK_GENERATOR TGZ)
find_program(DPKG_SHLIBDEPS dpkg-shlibdeps)
find_program(FILE_COMMAND file)
mark_as_advanced(DPKG_SHLIBDEPS FILE_COMMAND)
if(DPKG_SHLIBDEPS AND FILE_COMMAND)
    list(PREPEND CPACK_GENERATOR DEB)
else()
    message(STATUS "Without dpkg-shlibdeps and file, packages are an archive only (apt install dpkg-dev file)")
endif()
set(CPACK_STRIP_FILES ON)
set(CPACK_VERBATIM_VARIABLES ON)
set(CPACK_PROJECT_CONFIG_FILE ${CMAKE_CURRENT_LIST_DIR}/cpack_generators.cmake)

set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
set(CPACK_DEBIAN_PROGRAMS_PACKAGE_SECTION graphics)
set(CPACK_DEBIAN_PROGRAMS_PACKAGE_RECOMMENDS
    "mesa-vulkan-drivers | vulkan-icd, fonts-dejavu-core")
set(CPACK_DEBIAN_PROGRAMS_PACKAGE_SUGGESTS cw2-openimageio)
set(CPACK_DEBIAN_OPENIMAGEIO_PACKAGE_SECTION graphics)
set(CPACK_DEBIAN_OPENIMAGEIO_PACKAGE_DEPENDS "cw2 (= ${PROJECT_VERSION})")
set(CPACK_DEBIAN_LIBRARY_PACKAGE_SECTION libdevel)
set(CPACK_DEBIAN_LIBRARY_PACKAGE_RECOMMENDS "cw2, libzstd-dev")
set(CPACK_COMPONENT_PROGRAMS_DESCRIPTION
"cw2-bake turns OBJ and glTF into compact .cw2mesh files; cw2 draws any of
them with Vulkan, in a window or, with no display, into PNG and EXR pictures.")
set(CPACK_COMPONENT_OPENIMAGEIO_DESCRIPTION
"Lets cw2-bake read textures in any format that OpenImageIO reads; without it
these are PNG and JPEG.")
set(CPACK_COMPONENT_LIBRARY_DESCRIPTION
"Reads and checks .cw2mesh files in C++20 programs, with the standard library
alone; decodes compressed ones with Zstandard.")

foreach(package IN LISTS packages)
    string(REPLACE ":" ";" package ${package})
    list(GET package 0 component)
    list(GET package 1 name)
    list(APPEND CPACK_COMPONENTS_ALL ${component})
    string(TOUPPER ${component} upper)
    set(CPACK_DEBIAN_${upper}_PACKAGE_NAME ${name})
    set(CPACK_COMPONENT_${upper}_DISPLAY_NAME ${CPACK_PACKAGE_DESCRIPTION_SUMMARY})

    # What Debian asks of every package.
    set(about ${CMAKE_CURRENT_BINARY_DIR}/${name})
    configure_file(copyright.in ${about}/copyright @ONLY)
    configure_file(changelog.in ${about}/changelog @ONLY)
    execute_process(COMMAND gzip -9nkf ${about}/changelog COMMAND_ERROR_IS_FATAL ANY)
    install(FILES ${about}/copyright ${about}/changelog.gz
        DESTINATION share/doc/${name} COMPONENT ${component})
endforeach()
# A package takes what it holds, not all that there is to build.
set(CMAKE_SKIP_INSTALL_ALL_DEPENDENCY ON)
include(CPack)
