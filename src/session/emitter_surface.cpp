#include "session/emitter_surface.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "image/srgb_table.h"
#include "shading/texture_lookup.h"

namespace pertev {
namespace {

constexpr double kMaxLookups = 1 << 24;

/// Number of parts per edge, of about a texel each; at least 4, because the filter is not uniform.
int parts_of(const TextureRef& ref, const TextureImageView& image, const Vec2 (&uv)[3]) {
    double texels = 0;
    for (int k = 0; k < 3; ++k) {
        const Vec2 edge = transform_uv(ref, uv[(k + 1) % 3]) - transform_uv(ref, uv[k]);
        texels = std::max(
            {texels, static_cast<double>(abs(edge.x)) * image.width, static_cast<double>(abs(edge.y)) * image.height});
    }
    return static_cast<int>(std::clamp(std::ceil(texels), 4.0, 4096.0)); // 4 for NaN
}

/// Adds the mean over a triangle, times `weight`, to `sum`.
void add_mean(const TextureImageView* images, const TextureRef& ref, const Vec2 (&uv)[3], int parts, double weight,
              double (&sum)[3]) {
    double inside[3] = {};
    const float step = 1.0f / static_cast<float>(parts);
    const auto add = [&](float i, float j) { // the middle of a part, in thirds of a step
        const float b = i * step / 3, c = j * step / 3;
        const Vec4 colour =
            lookup_texture(images, ref, (1 - b - c) * uv[0] + b * uv[1] + c * uv[2], srgb_decode_table().data());
        inside[0] += static_cast<double>(colour.x);
        inside[1] += static_cast<double>(colour.y);
        inside[2] += static_cast<double>(colour.z);
    };
    for (int j = 0; j < parts; ++j) {
        for (int i = 0; i + j < parts; ++i) {
            add(static_cast<float>(3 * i + 1), static_cast<float>(3 * j + 1));
            if (i + j + 1 < parts) add(static_cast<float>(3 * i + 2), static_cast<float>(3 * j + 2));
        }
    }
    for (int k = 0; k < 3; ++k) sum[k] += weight * inside[k] / (static_cast<double>(parts) * parts);
}

} // namespace

EmitterSurface emitter_surface(const Scene& scene, const Instance& instance) {
    const Mesh& mesh = scene.meshes[instance.mesh];
    const TextureRef& ref = scene.materials[instance.material].emission_texture;
    std::vector<TextureImageView> images;
    if (ref.has_image()) {
        for (const TextureImage& image : scene.images) images.push_back(view_of(image));
    }
    const std::vector<Vec2>& coordinates = mesh.uv[ref.uv_set];
    const auto uv_at = [&](std::size_t k) { return coordinates.empty() ? Vec2{} : coordinates[mesh.indices[k]]; };
    const double max_parts = std::sqrt(kMaxLookups / std::max<double>(1, static_cast<double>(mesh.triangle_count())));

    EmitterSurface surface;
    double normals[3] = {}, colours[3] = {};
    for (std::size_t i = 0; i + 2 < mesh.indices.size(); i += 3) {
        const auto corner = [&](std::size_t k) {
            return transform_point(instance.world_from_local, mesh.positions[mesh.indices[i + k]]);
        };
        const Vec3 a = corner(0), ab = corner(1) - a, ac = corner(2) - a;
        const double x[] = {static_cast<double>(ab.x), static_cast<double>(ab.y), static_cast<double>(ab.z)};
        const double y[] = {static_cast<double>(ac.x), static_cast<double>(ac.y), static_cast<double>(ac.z)};
        const double normal[] = {x[1] * y[2] - x[2] * y[1], x[2] * y[0] - x[0] * y[2], x[0] * y[1] - x[1] * y[0]};
        const double area = 0.5 * std::sqrt(normal[0] * normal[0] + normal[1] * normal[1] + normal[2] * normal[2]);
        surface.area += area;
        for (int k = 0; k < 3; ++k) normals[k] += 0.5 * normal[k];
        if (!ref.has_image() || !(area > 0)) continue;
        const Vec2 uv[3] = {uv_at(i), uv_at(i + 1), uv_at(i + 2)};
        const int parts = std::min(parts_of(ref, images[static_cast<std::size_t>(ref.image)], uv),
                                   std::max(1, static_cast<int>(max_parts)));
        add_mean(images.data(), ref, uv, parts, area, colours);
    }
    // Area vectors of equal direction add up to the whole area.
    surface.is_flat =
        std::sqrt(normals[0] * normals[0] + normals[1] * normals[1] + normals[2] * normals[2]) > 0.9999 * surface.area;
    if (ref.has_image() && surface.area > 0) {
        for (int k = 0; k < 3; ++k) surface.texture[k] = colours[k] / surface.area;
    }
    return surface;
}

} // namespace pertev
