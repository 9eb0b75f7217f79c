#include "tests/render/brdf_truth.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

namespace {

double clamped_dot(const glm::dvec3& a, const glm::dvec3& b) {
    return std::max(0.0, glm::dot(a, b));
}

}  // namespace

Terms evaluate(const Surface& surface, const Illumination& illumination, const glm::dvec3& normal,
               const glm::dvec3& to_light, const glm::dvec3& to_camera) {
    const glm::dvec3 half = glm::normalize(to_light + to_camera);
    const double n_h = clamped_dot(normal, half);
    const double n_v = clamped_dot(normal, to_camera);
    const double n_l = clamped_dot(normal, to_light);
    const double v_h = clamped_dot(to_camera, half);

    Terms terms{};
    const double alpha = std::max(surface.roughness, 0.045);
    const double exponent = 2.0 / std::pow(alpha, 4.0) - 2.0;
    terms.distribution = (exponent + 2.0) / (2.0 * M_PI) * std::pow(n_h, exponent);
    terms.masking = std::min({1.0, 2.0 * n_h * n_v / v_h, 2.0 * n_h * n_l / v_h});
    const glm::dvec3 f0 = glm::mix(glm::dvec3(0.04), surface.color, surface.metalness);
    terms.fresnel = f0 + (1.0 - f0) * std::pow(1.0 - v_h, 5.0);
    terms.diffuse = surface.color / M_PI * (1.0 - terms.fresnel) * (1.0 - surface.metalness);
    if (n_v > 0.0 && n_l > 0.0) {
        terms.specular = terms.distribution * terms.masking * terms.fresnel / (4.0 * n_v * n_l);
    }
    terms.shaded = surface.emission / M_PI + illumination.ambient * surface.color +
                   (terms.diffuse + terms.specular) * illumination.light * n_l;
    return terms;
}
