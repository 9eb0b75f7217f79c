#include "tests/render/scene_writer.h"

#include <fmt/format.h>

#include <cmath>
#include <glm/geometric.hpp>

namespace {

/// No minus sign before zeros: it would depend on rounding.
std::string number(double value) {
    const std::string text = fmt::format("{:.6f}", value);
    return text == "-0.000000" ? "0.000000" : text;
}

}  // namespace

SceneWriter::SceneWriter(const std::filesystem::path& folder, const std::string& name,
                         std::function<glm::dvec3(glm::dvec3)> turn)
    : obj_(folder / (name + ".obj")), mtl_(folder / (name + ".mtl")), turn_(std::move(turn)) {
    obj_.exceptions(std::ios::failbit | std::ios::badbit);
    mtl_.exceptions(std::ios::failbit | std::ios::badbit);
    line("mtllib " + name + ".mtl");
}

void SceneWriter::material(const std::string& name, const std::vector<std::string>& lines) {
    mtl_ << "newmtl " << name << '\n';
    for (const std::string& text : lines) mtl_ << text << '\n';
    line("usemtl " + name);
}

void SceneWriter::line(const std::string& text) {
    obj_ << text << '\n';
}

void SceneWriter::polygon(const std::vector<Corner>& corners, Attributes attributes) {
    const bool uvs = attributes == Attributes::uvs || attributes == Attributes::both;
    const bool normals = attributes == Attributes::normals || attributes == Attributes::both;
    const auto text_of = [](const glm::dvec3& v) {
        return fmt::format(" {} {} {}", number(v.x), number(v.y), number(v.z));
    };
    const auto turned = [&](const glm::dvec3& v) { return text_of(turn_ ? turn_(v) : v); };
    for (const Corner& corner : corners) {
        line(fmt::format("v{}{}", turned(corner.position),
                         corner.color ? text_of(*corner.color) : std::string()));
        if (uvs) line(fmt::format("vt {} {}", number(corner.uv.x), number(corner.uv.y)));
        if (normals) line(fmt::format("vn{}", turned(corner.normal)));
    }
    std::string face = "f";
    const int count = static_cast<int>(corners.size());
    for (int i = -count; i < 0; ++i) {
        face += fmt::format(" {}", i);
        if (uvs || normals) face += '/';
        if (uvs) face += std::to_string(i);
        if (normals) face += fmt::format("/{}", i);
    }
    line(face);
}

void SceneWriter::quad(glm::dvec3 origin, glm::dvec3 right, glm::dvec3 up, glm::dvec2 repeat) {
    const glm::dvec3 normal = glm::normalize(glm::cross(right, up));
    polygon({{origin, {0.0, 0.0}, normal},
             {origin + right, {repeat.x, 0.0}, normal},
             {origin + right + up, repeat, normal},
             {origin + up, {0.0, repeat.y}, normal}});
}

void SceneWriter::sphere(glm::dvec3 center, double radius, int slices, int rings,
                         Attributes attributes) {
    const auto corner = [&](int slice, int ring) {
        const double u = static_cast<double>(slice) / slices;
        const double v = static_cast<double>(ring) / rings;
        const double longitude = 2.0 * M_PI * u;
        const double latitude = M_PI * (v - 0.5);
        const glm::dvec3 normal(std::cos(latitude) * std::sin(longitude), std::sin(latitude),
                                std::cos(latitude) * std::cos(longitude));
        return Corner{center + radius * normal, {u, v}, normal};
    };
    for (int ring = 0; ring < rings; ++ring) {
        for (int slice = 0; slice < slices; ++slice) {
            std::vector<Corner> corners{corner(slice, ring)};
            if (ring > 0) corners.push_back(corner(slice + 1, ring));
            corners.push_back(corner(slice + 1, ring + 1));
            if (ring < rings - 1) corners.push_back(corner(slice, ring + 1));
            polygon(corners, attributes);
        }
    }
}

void SceneWriter::cube(glm::dvec3 center, double half, double degrees) {
    const double angle = degrees * M_PI / 180.0;
    const glm::dvec3 x(std::cos(angle), 0.0, -std::sin(angle));
    const glm::dvec3 y(0.0, 1.0, 0.0);
    const glm::dvec3 z(std::sin(angle), 0.0, std::cos(angle));
    const auto side = [&](glm::dvec3 right, glm::dvec3 up) {
        quad(center + half * (glm::cross(right, up) - right - up), 2.0 * half * right,
             2.0 * half * up);
    };
    side(x, y);
    side(-x, y);
    side(z, y);
    side(-z, y);
    side(x, -z);
    side(x, z);
}
