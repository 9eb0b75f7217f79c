#include "assets/scene.h"

namespace assets {

Model courtyard() {
    Model model;
    add_walls_and_floors(model);
    add_arcades(model);
    add_roof(model);
    return model;
}

}  // namespace assets
