# find_package(cw2): the library cw2::mesh-format.
include(${CMAKE_CURRENT_LIST_DIR}/cw2-targets.cmake)
