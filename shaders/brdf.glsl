// The reflectance model: Lambert diffuse, Blinn-Phong microfacet specular.
// Sources: Blinn 1977 (distribution, masking), Schlick 1994 (Fresnel), Boksansky, "Crash Course in
// BRDF Implementation" (their combination). All vectors are of unit length and point away from the
// surface; alpha is the roughness.

const float kPi = 3.14159265358979;

// Below this the exponent of the distribution would leave the range that a float resolves.
const float kMinimumAlpha = 0.045;

struct Surface {
    vec3 base_color;  // linear
    float alpha;      // roughness
    float metalness;
    vec3 normal;
};

struct Brdf {
    vec3 diffuse;           // before light colour and n.l
    vec3 specular;          // the same; 0 where n.l or n.v is not positive
    vec3 specular_n_dot_l;  // specular * n.l, finite where either vanishes
    float distribution;     // D
    float masking;          // G
    vec3 fresnel;           // F
    float n_dot_l;          // clamped to [0, 1]
};

// log(1 - x) for x in [0, 1]; near 0 by the series of -2 atanh(x / (2 - x)), because 1 - x would
// round away what a large exponent then amplifies.
float log_one_minus(float x) {
    if (x > 0.25) return log(1.0 - x);
    const float t = x / (2.0 - x);
    const float t2 = t * t;
    return -2.0 * t * (1.0 + t2 * (1.0 / 3.0 + t2 * (1.0 / 5.0 + t2 * (1.0 / 7.0 + t2 / 9.0))));
}

// D = (a + 2) / (2 pi) (n.h)^a with a = 2 / alpha^4 - 2. The power is taken of
// 1 - |n x h|^2 = (n.h)^2, which keeps its digits where n.h rounds to 1.
float blinn_phong_distribution(vec3 n, vec3 h, float alpha) {
    const float clamped = max(alpha, kMinimumAlpha);
    const float square = clamped * clamped;
    const float exponent = 2.0 / (square * square) - 2.0;
    const float scale = (exponent + 2.0) / (2.0 * kPi);
    if (exponent <= 0.0) return scale;
    if (dot(n, h) <= 0.0) return 0.0;
    const vec3 perpendicular = cross(n, h);
    const float square_sine = min(dot(perpendicular, perpendicular), 1.0);
    if (square_sine == 1.0) return 0.0;
    return scale * exp(0.5 * exponent * log_one_minus(square_sine));
}

vec3 schlick_fresnel(vec3 f0, float v_dot_h) {
    const float m = 1.0 - v_dot_h;
    const float m2 = m * m;
    return f0 + (1.0 - f0) * (m2 * m2 * m);
}

// `l` to the light, `v` to the camera.
Brdf evaluate_brdf(Surface surface, vec3 l, vec3 v) {
    const vec3 n = surface.normal;
    // Where the light stands exactly opposite the camera any h will do: n.l or n.v is 0.
    const vec3 l_plus_v = l + v;
    const vec3 h = dot(l_plus_v, l_plus_v) > 0.0 ? normalize(l_plus_v) : n;
    const float n_dot_l = clamp(dot(n, l), 0.0, 1.0);
    const float n_dot_v = clamp(dot(n, v), 0.0, 1.0);
    const float n_dot_h = clamp(dot(n, h), 0.0, 1.0);
    const float v_dot_h = clamp(dot(v, h), 1e-20, 1.0);

    Brdf brdf;
    brdf.n_dot_l = n_dot_l;
    brdf.distribution = blinn_phong_distribution(n, h, surface.alpha);
    brdf.masking = min(1.0, 2.0 * n_dot_h * min(n_dot_v, n_dot_l) / v_dot_h);
    const vec3 f0 = mix(vec3(0.04), surface.base_color, surface.metalness);
    brdf.fresnel = schlick_fresnel(f0, v_dot_h);
    brdf.diffuse = surface.base_color / kPi * (1.0 - brdf.fresnel) * (1.0 - surface.metalness);
    brdf.specular = vec3(0.0);
    brdf.specular_n_dot_l = vec3(0.0);
    if (n_dot_l > 0.0 && n_dot_v > 0.0) {
        // G / (4 n.v n.l) with the division carried out in each of G's three cases, so that what
        // cancels is never divided by.
        const vec3 df = brdf.distribution * brdf.fresnel;
        const float half_ratio = n_dot_h / (2.0 * v_dot_h);
        brdf.specular_n_dot_l =
            df * min(min(1.0 / (4.0 * n_dot_v), half_ratio), half_ratio * n_dot_l / n_dot_v);
        brdf.specular = df * min(min(1.0 / (4.0 * n_dot_v * n_dot_l), half_ratio / n_dot_l),
                                 half_ratio / n_dot_v);
    }
    return brdf;
}
