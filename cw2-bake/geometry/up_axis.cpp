#include "cw2-bake/geometry/up_axis.h"

namespace bake {

void turn_z_up(SourceScene& scene) {
    const auto turn = [](auto& v) { v = {v.x, v.z, 0.0f - v.y}; };  // -y could be -0
    turn(scene.origin);
    for (glm::vec3& position : scene.positions) turn(position);
    for (glm::vec3& normal : scene.normals) turn(normal);
    for (glm::vec4& tangent : scene.tangents) {
        glm::vec3 direction(tangent);
        turn(direction);
        tangent = glm::vec4(direction, tangent.w);
    }
    if (scene.camera) {
        turn(scene.camera->position);
        turn(scene.camera->target);
    }
    if (scene.light) turn(scene.light->position);
}

}  // namespace bake
