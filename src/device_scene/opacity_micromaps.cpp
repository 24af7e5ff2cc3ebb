#include "device_scene/opacity_micromaps.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <span>
#include <utility>

#include "device/launch.h"
#include "device_scene/classify_opacity.h"

namespace pertev {
namespace {

constexpr double kTexelsEach = 1;            // maximum texels per micro-triangle
constexpr std::size_t kMaxWords = 64u << 20; // maximum for all, a quarter of a gigabyte; levels are coarser if
                                             // needed

/// A mesh with a material; the material comes first, so that maps of a material are adjacent.
using MaterialAndMesh = std::pair<uint32_t, uint32_t>;

struct Micromap {
    uint32_t level;
    std::size_t triangles, first_word;
    std::size_t words() const { return triangles * words_per_triangle(level); }
};

bool has_micromap(const Scene& scene, const Instance& instance) {
    const Material& material = scene.materials[instance.material];
    return material.alpha_mode != AlphaMode::Opaque && scene.meshes[instance.mesh].triangle_count() > 0 &&
           (material.base_color_texture.has_image() || material.alpha_texture.has_image());
}

/// Mean number of texels per triangle, from some thousand of them.
double texels_of_a_triangle(const Scene& scene, const Mesh& mesh, const TextureRef& ref) {
    const std::vector<Vec2>& uv = mesh.uv[ref.uv_set];
    if (!ref.has_image() || uv.empty()) return 0;
    const TextureImageView image = view_of(scene.images[static_cast<std::size_t>(ref.image)]);
    const std::size_t count = mesh.triangle_count(), step = count / 1024 + 1;
    double area = 0;
    for (std::size_t i = 0; i < count; i += step) {
        const Vec2 a = uv[mesh.indices[3 * i]], b = uv[mesh.indices[3 * i + 1]], c = uv[mesh.indices[3 * i + 2]];
        area += 0.5 * std::abs(static_cast<double>(b.x - a.x) * static_cast<double>(c.y - a.y) -
                               static_cast<double>(b.y - a.y) * static_cast<double>(c.x - a.x));
    }
    const double scale = std::abs(static_cast<double>(ref.m00 * ref.m11 - ref.m01 * ref.m10));
    const double texels = area * scale * image.width * image.height / static_cast<double>((count + step - 1) / step);
    return std::isfinite(texels) ? texels : 0;
}

uint32_t level_for(const Scene& scene, const Mesh& mesh, const Material& material) {
    const double texels = std::max(texels_of_a_triangle(scene, mesh, material.base_color_texture),
                                   texels_of_a_triangle(scene, mesh, material.alpha_texture));
    uint32_t level = kMinMicroLevel;
    while (level < kMaxMicroLevel && texels > kTexelsEach * micro_triangles(level)) ++level;
    return level;
}

/// Lists micromaps in a fixed order, with the total number of words.
std::map<MaterialAndMesh, Micromap> list_micromaps(const Scene& scene, std::size_t& words) {
    std::map<MaterialAndMesh, Micromap> maps;
    for (const Instance& instance : scene.instances) {
        if (!has_micromap(scene, instance)) continue;
        const auto [entry, is_new] = maps.try_emplace({instance.material, instance.mesh});
        if (!is_new) continue;
        const Mesh& mesh = scene.meshes[instance.mesh];
        entry->second = {level_for(scene, mesh, scene.materials[instance.material]), mesh.triangle_count(), 0};
    }
    for (uint32_t most = kMaxMicroLevel;; --most) {
        words = 0;
        for (auto& [pair, map] : maps) {
            map.level = std::min(map.level, most);
            map.first_word = words;
            words += map.words();
        }
        if (words <= kMaxWords || most == kMinMicroLevel) return maps;
    }
}

/// The pyramid of a texture's channel; valid as long as the buffers.
TexelBoundsView make_bounds(Queue& queue, const Scene& scene, const SceneView& view, const TextureRef& ref,
                            uint32_t channel, std::vector<Buffer<ValueRange>>& buffers) {
    TexelBoundsView bounds = {};
    if (!ref.has_image()) return bounds;
    const auto number = static_cast<std::size_t>(ref.image);
    const TextureImageView image = view_of(scene.images[number]);
    bounds.image = view.images + number;
    bounds.channel = channel;
    bounds.is_srgb = ref.is_srgb;
    bounds.linear_from_srgb = view.linear_from_srgb;
    for (uint32_t level = 1; halved(image.width, level - 1) > 1 || halved(image.height, level - 1) > 1; ++level) {
        const std::size_t cells = std::size_t(halved(image.width, level)) * halved(image.height, level);
        buffers.emplace_back(queue, cells, "bounds of a texture's alpha");
        launch(queue, "halve texel bounds", static_cast<uint32_t>(cells),
               HalveTexelBounds{bounds, level, buffers.back().data()});
        bounds.levels[level] = buffers.back().data();
    }
    return bounds;
}

} // namespace

void OpacityMicromaps::update(Queue& queue, const Scene& scene, const SceneView& view, bool have_changed) {
    std::vector<uint64_t> wanted;
    for (const Instance& instance : scene.instances)
        wanted.push_back(has_micromap(scene, instance) ? uint64_t(instance.material) << 32 | instance.mesh
                                                       : ~uint64_t(0));
    if (!have_changed && wanted == made_for_) return;

    *this = OpacityMicromaps(); // freed before the new ones, so that both need not fit
    std::size_t words = 0;
    const std::map<MaterialAndMesh, Micromap> maps = list_micromaps(scene, words);
    if (maps.empty()) return;
    Buffer<uint32_t> states(queue, words, "opacity micromaps");
    for (auto first = maps.begin(); first != maps.end();) {
        const uint32_t number = first->first.first;
        const Material& material = scene.materials[number];
        std::vector<Buffer<ValueRange>> buffers;
        ClassifyOpacity stage = {
            view,
            0,
            number,
            0,
            make_bounds(queue, scene, view, material.base_color_texture, 3, buffers),
            make_bounds(queue, scene, view, material.alpha_texture, material.alpha_texture.channel, buffers),
            nullptr};
        for (; first != maps.end() && first->first.first == number; ++first) {
            stage.mesh = first->first.second;
            stage.level = first->second.level;
            stage.words = states.data() + first->second.first_word;
            launch(queue, "classify opacity", static_cast<uint32_t>(first->second.words()), stage);
        }
    }
    std::vector<OpacityMicromapView> views;
    for (const Instance& instance : scene.instances) {
        const auto map = maps.find({instance.material, instance.mesh});
        views.push_back(map == maps.end()
                            ? OpacityMicromapView{}
                            : OpacityMicromapView{states.data() + map->second.first_word, map->second.level});
    }
    of_instances_ =
        Buffer<OpacityMicromapView>(queue, std::span<const OpacityMicromapView>(views), "opacity micromaps");
    states_ = std::move(states);
    made_for_ = std::move(wanted);
}

} // namespace pertev
