// A .gltf or .glb, which may name a.png.
#include "tests/fuzz/fuzzing.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    fuzzing::write("scene.gltf", {data, size});
    fuzzing::bake_any("scene.gltf", {data, size});
    return 0;
}
