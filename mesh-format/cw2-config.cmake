# find_package(cw2): the library cw2::mesh-format, and cw2_bake() where cw2-bake is built, too.
include(${CMAKE_CURRENT_LIST_DIR}/cw2-targets.cmake)
include(${CMAKE_CURRENT_LIST_DIR}/cw2_bake.cmake OPTIONAL)
