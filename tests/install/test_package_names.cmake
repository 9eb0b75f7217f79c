# What is missing is named as the system at hand names it. Run by cmake -P.
cmake_minimum_required(VERSION 3.25)
include(${CMAKE_CURRENT_LIST_DIR}/../../third_party/package_names.cmake)

function(expect ids packages expected)
    how_to_install("${packages}" "${ids}" how)
    if(NOT how STREQUAL expected)
        message(SEND_ERROR "on '${ids}': '${how}', not '${expected}'")
    endif()
endfunction()

set(packages g++ libtbb-dev libimgui-dev)
expect("debian " "${packages}" "apt install g++ libtbb-dev libimgui-dev")
expect("ubuntu debian" libfmt-dev "apt install libfmt-dev")
expect("fedora " "${packages}"
    "dnf install gcc-c++ tbb-devel; by hand, by their names in Debian: libimgui-dev")
expect("rocky rhel centos fedora" libfmt-dev "dnf install fmt-devel")
expect("manjaro arch" "${packages}"
    "pacman -S gcc onetbb; by hand, by their names in Debian: libimgui-dev")
expect("arch " "glslang-tools;glslang-dev" "pacman -S glslang")

# Each row has the three names.
file(STRINGS ${CMAKE_CURRENT_LIST_DIR}/../../third_party/packages.txt lines REGEX "^[^#]")
foreach(line IN LISTS lines)
    if(NOT line MATCHES "^[a-z0-9+.-]+ +[A-Za-z0-9+_.-]+ +[a-z0-9+_.-]+( +#.*)?$")
        message(SEND_ERROR "packages.txt: ${line}")
    endif()
endforeach()
