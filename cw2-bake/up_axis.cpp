#include "cw2-bake/up_axis.h"

namespace bake {

void turn_z_up(SourceScene& scene) {
    const auto turn = [](glm::vec3& v) { v = {v.x, v.z, 0.0f - v.y}; };  // -y could be -0
    for (glm::vec3& position : scene.positions) turn(position);
    for (glm::vec3& normal : scene.normals) turn(normal);
}

}  // namespace bake
