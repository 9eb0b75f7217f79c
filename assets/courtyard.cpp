#include "assets/scene.h"

namespace assets {

Model courtyard() {
    Model model;
    add_walls_and_floors(model);
    add_arcades(model);
    add_roof(model);
    add_sculpture(model);
    add_furnishings(model);
    add_plants(model);
    return model;
}

}  // namespace assets
