// An OBJ; behind a NUL the MTL m.mtl, which may name a.png.
#include <algorithm>

#include "tests/fuzz/fuzzing.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const std::span bytes(data, size);
    const auto obj_bytes =
        static_cast<std::size_t>(std::find(bytes.begin(), bytes.end(), 0) - bytes.begin());
    fuzzing::write("scene.obj", bytes.first(obj_bytes));
    fuzzing::write("m.mtl", bytes.subspan(std::min(obj_bytes + 1, size)));
    fuzzing::bake_any("scene.obj", bytes);
    return 0;
}
