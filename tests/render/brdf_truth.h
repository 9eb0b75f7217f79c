// What a fragment shows, evaluated in double precision from the formulas' sources: J. Boksansky,
// "Crash Course in BRDF Implementation" (2021); J. Blinn, "Models of Light Reflection for Computer
// Synthesized Pictures" (1977); C. Schlick, "An Inexpensive BRDF Model" (1994).
#pragma once

#include <glm/vec3.hpp>

struct Surface {
    glm::dvec3 color;          ///< linear
    double roughness;          ///< in [0, 1]
    double metalness;          ///< in [0, 1]
    glm::dvec3 emission{0.0};  ///< 1 is as bright as white paper that faces a light of colour 1
};

struct Illumination {
    glm::dvec3 light;    ///< colour of the point light
    glm::dvec3 ambient;  ///< colour
};

/// The terms of the shading model, named as cw2's views.
struct Terms {
    double distribution;
    double masking;
    glm::dvec3 fresnel;
    glm::dvec3 diffuse;
    glm::dvec3 specular;  ///< 0 where light or camera is below the horizon
    glm::dvec3 shaded;
};

/// Unit vectors: `normal`; `to_light` and `to_camera` from the surface.
Terms evaluate(const Surface& surface, const Illumination& illumination, const glm::dvec3& normal,
               const glm::dvec3& to_light, const glm::dvec3& to_camera);
