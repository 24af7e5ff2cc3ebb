#include "scene/invisible_materials.h"

#include <algorithm>
#include <vector>

#include <fmt/format.h>

#include "base/message_text.h"
#include "math/scalar.h"

namespace pertev {
namespace {

constexpr std::size_t kMaxNamed = 10;

/// Returns the largest value of a texture's channel; at most 1.
float greatest_texel(const Scene& scene, const TextureRef& ref, std::size_t channel) {
    if (!ref.has_image()) return 1;
    const TextureImage& image = scene.images[static_cast<std::size_t>(ref.image)];
    uint8_t greatest_byte = 0;
    const std::vector<uint8_t>& bytes = image.rgba8.pixels;
    for (std::size_t i = channel; i < bytes.size() && greatest_byte < 255; i += 4) {
        greatest_byte = std::max(greatest_byte, bytes[i]);
    }
    float greatest = static_cast<float>(greatest_byte) / 255;
    const std::vector<float>& floats = image.rgba_float.pixels;
    for (std::size_t i = channel; i < floats.size() && greatest < 1; i += 4) greatest = max(greatest, floats[i]);
    return min(greatest, 1.0f);
}

float greatest_vertex_alpha(const Mesh& mesh) {
    if (mesh.colors.empty()) return 1;
    float greatest = 0;
    for (std::size_t i = 0; i < mesh.colors.size() && greatest < 1; ++i) greatest = max(greatest, mesh.colors[i].w);
    return greatest;
}

bool lets_all_through(const Material& material, float opacity) {
    return material.alpha_mode == AlphaMode::Mask ? opacity < material.alpha_cutoff : !(opacity > 0);
}

} // namespace

void warn_of_invisible_materials(const Scene& scene, const std::string& file, Sink& sink) {
    std::vector<float> opacity(scene.materials.size());
    for (std::size_t i = 0; i < scene.materials.size(); ++i) {
        const Material& material = scene.materials[i];
        if (material.alpha_mode == AlphaMode::Opaque) continue;
        opacity[i] = material.alpha;
        if (lets_all_through(material, opacity[i])) continue;
        opacity[i] *= greatest_texel(scene, material.base_color_texture, 3) *
                      greatest_texel(scene, material.alpha_texture, material.alpha_texture.channel);
    }
    std::vector<std::size_t> unseen(scene.materials.size()), seen(scene.materials.size());
    for (const Instance& instance : scene.instances) {
        const Material& material = scene.materials[instance.material];
        const float own = opacity[instance.material];
        const bool is_opaque = material.alpha_mode == AlphaMode::Opaque;
        const bool is_unseen =
            !is_opaque && (lets_all_through(material, own) ||
                           lets_all_through(material, own * greatest_vertex_alpha(scene.meshes[instance.mesh])));
        ++(is_unseen ? unseen : seen)[instance.material];
    }
    std::size_t invisible = 0;
    for (std::size_t i = 0; i < scene.materials.size(); ++i) {
        const Material& material = scene.materials[i];
        if (material.is_clear_boundary || unseen[i] == 0 || seen[i] > 0 || invisible++ >= kMaxNamed) continue;
        sink.warn(
            {FileLocation{file}, fmt::format("the material {} is invisible{}, because its alpha is 0 or below its "
                                             "cutoff (in MTL d 0 or Tr 1); {} with it are not shown",
                                             material.name.empty() ? fmt::format("{}", i) : material.name,
                                             material.origin.empty() ? "" : fmt::format(" ({})", material.origin),
                                             counted(unseen[i], "surface"))});
    }
    if (invisible > kMaxNamed) {
        sink.warn(
            {FileLocation{file}, fmt::format("{} {} invisible", counted(invisible - kMaxNamed, "further material"),
                                             is_or_are(invisible - kMaxNamed))});
    }
}

} // namespace pertev
