// make-demo-scene OUTPUT_DIR: writes courtyard.obj, courtyard.mtl and textures/*.png.
#include <cstdio>
#include <exception>

#include "assets/demo_scene.h"

int main(int argument_count, char** arguments) {
    if (argument_count != 2 || arguments[1][0] == '-') {
        std::fputs("usage: make-demo-scene OUTPUT_DIR\n", stderr);
        return 2;
    }
    try {
        assets::write_demo_scene(arguments[1]);
    } catch (const std::exception& error) {
        std::fprintf(stderr, "make-demo-scene: %s\n", error.what());
        return 1;
    }
    return 0;
}
