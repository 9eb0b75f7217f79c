#include "cw2/render/picker.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <glm/geometric.hpp>
#include <glm/vec4.hpp>

#include "common/quoted_text.h"

namespace cw2 {

namespace {

/// What is read, in this order.
constexpr std::array kReadings{
    interop::kReadMaterial,       interop::kReadPosition,      interop::kViewNormal,
    interop::kViewLightDirection, interop::kViewViewDirection, interop::kViewBaseColor,
    interop::kViewRoughness,      interop::kViewMetalness,     interop::kViewDistribution,
    interop::kViewMasking,        interop::kViewFresnel,       interop::kViewDiffuse,
    interop::kViewSpecular,       interop::kViewShaded,        interop::kViewEmission,
    interop::kViewVertexColor};
using Values = std::array<glm::vec4, kReadings.size()>;

constexpr VkFormat kFormat = VK_FORMAT_R32G32B32A32_SFLOAT;
constexpr ImageUse kCopied{VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, VK_PIPELINE_STAGE_2_COPY_BIT,
                           VK_ACCESS_2_TRANSFER_READ_BIT};

Pick pick_of(const Values& values, glm::uvec2 pixel, const Bounds& bounds) {
    const auto value = [&](std::uint32_t reading) {
        const auto at = std::find(kReadings.begin(), kReadings.end(), reading) - kReadings.begin();
        return glm::vec3(values[static_cast<std::size_t>(at)]);
    };
    const auto direction = [&](std::uint32_t reading) {
        return glm::normalize(2.0f * value(reading) - 1.0f);
    };
    return {.pixel = pixel,
            .material = static_cast<std::uint32_t>(value(interop::kReadMaterial).x),
            .position = to_user(value(interop::kReadPosition), bounds),
            .normal = direction(interop::kViewNormal),
            .to_light = direction(interop::kViewLightDirection),
            .to_camera = direction(interop::kViewViewDirection),
            .base_color = value(interop::kViewBaseColor),
            .vertex_color = value(interop::kViewVertexColor),
            .emission = value(interop::kViewEmission),
            .unlit = value(interop::kReadMaterial).y != 0.0f,
            .roughness = value(interop::kViewRoughness).x,
            .metalness = value(interop::kViewMetalness).x,
            .distribution = value(interop::kViewDistribution).x,
            .masking = value(interop::kViewMasking).x,
            .fresnel = value(interop::kViewFresnel),
            .diffuse = value(interop::kViewDiffuse),
            .specular = value(interop::kViewSpecular),
            .shaded = value(interop::kViewShaded)};
}

float cosine(const glm::vec3& a, const glm::vec3& b) {
    return std::clamp(glm::dot(a, b), 0.0f, 1.0f);
}

glm::vec3 half_way(const Pick& pick) {
    const glm::vec3 sum = pick.to_light + pick.to_camera;
    return sum == glm::vec3(0.0f) ? pick.normal : glm::normalize(sum);
}

}  // namespace

float Pick::n_dot_l() const {
    return cosine(normal, to_light);
}

float Pick::n_dot_v() const {
    return cosine(normal, to_camera);
}

float Pick::n_dot_h() const {
    return cosine(normal, half_way(*this));
}

float Pick::v_dot_h() const {
    return cosine(to_camera, half_way(*this));
}

std::string describe(const Pick& pick, const std::string& material) {
    const auto vector = [](const auto& v) { return fmt::format("{},{},{}", v.x, v.y, v.z); };
    return fmt::format(
        "pixel {},{}: material {}; position {}; normal {}; base color {}{}; vertex color {}; "
        "emission {}; roughness {}; metalness {}; n.l {}; n.v {}; n.h {}; v.h {}; D {}; G {}; F "
        "{}; diffuse {}; specular {}; "
        "shaded {}",
        pick.pixel.x, pick.pixel.y, material, vector(pick.position), vector(pick.normal),
        vector(pick.base_color), pick.unlit ? " unlit" : "", vector(pick.vertex_color),
        vector(pick.emission), pick.roughness, pick.metalness, pick.n_dot_l(), pick.n_dot_v(),
        pick.n_dot_h(), pick.v_dot_h(), pick.distribution, pick.masking, vector(pick.fresnel),
        vector(pick.diffuse), vector(pick.specular), vector(pick.shaded));
}

std::string json_of(glm::uvec2 pixel, const std::optional<Pick>& pick,
                    const std::string& material) {
    const auto number = [](auto x) {
        return std::isfinite(x) ? fmt::format("{}", x) : std::string("null");
    };
    std::string json = fmt::format("{{\n  \"pixel\": [{}, {}],\n", pixel.x, pixel.y);
    if (!pick) return json + "  \"material\": null\n}\n";
    const auto add = [&](const char* name, const std::string& value) {
        json += fmt::format(",\n  \"{}\": {}", name, value);
    };
    const auto vector = [&](const char* name, const auto& v) {
        add(name, fmt::format("[{}, {}, {}]", number(v.x), number(v.y), number(v.z)));
    };
    json += fmt::format("  \"material\": {}", common::quoted_text(material));
    vector("position", pick->position);
    vector("normal", pick->normal);
    vector("to_light", pick->to_light);
    vector("to_camera", pick->to_camera);
    vector("base_color", pick->base_color);
    vector("vertex_color", pick->vertex_color);
    vector("emission", pick->emission);
    add("unlit", pick->unlit ? "true" : "false");
    add("roughness", number(pick->roughness));
    add("metalness", number(pick->metalness));
    add("n_dot_l", number(pick->n_dot_l()));
    add("n_dot_v", number(pick->n_dot_v()));
    add("n_dot_h", number(pick->n_dot_h()));
    add("v_dot_h", number(pick->v_dot_h()));
    add("distribution", number(pick->distribution));
    add("masking", number(pick->masking));
    vector("fresnel", pick->fresnel);
    vector("diffuse", pick->diffuse);
    vector("specular", pick->specular);
    vector("shaded", pick->shaded);
    return json + "\n}\n";
}

Picker::Picker(const Device& device, const Layouts& layouts, const ShaderCode& code)
    : device_(device),
      renderer_(device, layouts, code, kFormat, VK_SAMPLE_COUNT_1_BIT, 1),
      values_(make_buffer(device, sizeof(Values), VK_BUFFER_USAGE_TRANSFER_DST_BIT,
                          MemoryUse::readback)),
      pool_(make_command_pool(device)),
      commands_(allocate_commands(device, pool_.get())) {}

void Picker::fit(VkExtent2D extent) {
    if (extent.width == extent_.width && extent.height == extent_.height) return;
    image_ = make_image(
        device_, {.format = kFormat,
                  .extent = extent,
                  .usage = VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT});
    device_.name(image_.handle.get(), "picked pixels");
    extent_ = extent;
}

std::optional<Pick> Picker::pick(const Scene& scene, const FrameSettings& settings,
                                 VkExtent2D extent, glm::uvec2 pixel) {
    fit(extent);
    // The picture is as large as the one that is shown, so that the pixel covers the same.
    const VkRect2D area{{static_cast<std::int32_t>(pixel.x), static_cast<std::int32_t>(pixel.y)},
                        {1, 1}};
    FrameSettings read = settings;
    if (read.split && pixel.x >= read.split->column(extent.width)) {
        static_cast<Side&>(read) = read.split->right;
    }
    read.split.reset();
    read.false_color.reset();
    read.exposure = 0.0f;
    read.one_pipeline = true;
    begin_commands(commands_);
    for (std::size_t i = 0; i < kReadings.size(); ++i) {
        read.view = kReadings[i];
        renderer_.record(commands_, 0, scene,
                         {.image = image_.handle.get(),
                          .view = image_.view.get(),
                          .extent = extent,
                          .available_at = kCopied.stages,
                          .after = kCopied,
                          .area = area},
                         read);
        read_back(commands_, image_.handle.get(), area, values_, i * sizeof(glm::vec4));
    }
    submit_and_wait(device_, commands_);
    Values values;
    std::memcpy(values.data(), values_.mapped.data(), sizeof values);
    if (values.front().w == 0.0f) return std::nullopt;
    return pick_of(values, pixel, scene.bounds());
}

}  // namespace cw2
