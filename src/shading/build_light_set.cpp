#include "shading/build_light_set.h"

#include <algorithm>
#include <map>
#include <utility>

#include "base/error.h"
#include "base/limits.h"
#include "base/parallel_for.h"
#include "shading/brightness_pyramid.h"

namespace pertev {
namespace {

constexpr double kPiDouble = 3.141592653589793;

double mean_of_channels(Rgb c) {
    return (static_cast<double>(c.r) + static_cast<double>(c.g) + static_cast<double>(c.b)) / 3.0;
}

/// Pyramids of the textures that lights of the scene emit by, each (image, encoding) once.
using Pyramids = std::map<std::pair<int32_t, bool>, BrightnessPyramid>;

Pyramids build_pyramids(const LightSetData& data, const std::vector<TextureImageView>& images,
                        const float* linear_from_srgb) {
    Pyramids pyramids;
    for (const SurfaceEmission& surface : data.emissions) {
        const TextureRef& ref = surface.texture;
        if (ref.image == kNoImage || is_black(surface.emission)) continue;
        const auto key = std::pair(ref.image, ref.is_srgb);
        if (pyramids.contains(key)) continue;
        const TextureImageView& image = images[static_cast<std::size_t>(ref.image)];
        pyramids.try_emplace(key, image, ref.is_srgb, linear_from_srgb);
    }
    return pyramids;
}

double triangle_power(const LightSetData& data, const Pyramids& pyramids, const EmissiveTriangle& triangle) {
    const Vec3 normal = cross(triangle.ab, triangle.ac);
    const double area = 0.5 * static_cast<double>(length(normal));
    if (!(dot(normal, normal) > 0)) return 0; // no area, or too small to divide by
    const SurfaceEmission& surface = data.emissions[triangle.material];
    const double untextured = 2 * kPiDouble * area * mean_of_channels(surface.emission);
    const TextureRef& ref = surface.texture;
    if (ref.image == kNoImage) return untextured;
    const BrightnessPyramid& pyramid = pyramids.at({ref.image, ref.is_srgb});
    return untextured * pyramid.mean_over_triangle(ref, triangle.uv0, triangle.uv1, triangle.uv2);
}

double punctual_power(const PunctualLight& light, double radius) {
    const double intensity = mean_of_channels(light.intensity);
    const double inner = static_cast<double>(light.cos_inner), outer = static_cast<double>(light.cos_outer);
    switch (light.kind) {
    case LightKind::Point:
        return 4 * kPiDouble * intensity;
    case LightKind::Spot:
        return 2 * kPiDouble * intensity * ((1 - inner) + std::max(inner - outer, 0.001) / 3);
    case LightKind::Directional:
        return kPiDouble * radius * radius * intensity;
    }
    return 0;
}

bool is_light(const Material& material) { return material.is_emissive() && material.kind != MaterialKind::Unlit; }

void add_triangles(const Scene& scene, Vec3 centre, LightSetData& data) {
    uint64_t count = 0;
    data.first_light.assign(scene.instances.size(), kNoLight);
    for (std::size_t i = 0; i < scene.instances.size(); ++i) {
        const Instance& instance = scene.instances[i];
        if (!is_light(scene.materials[instance.material])) continue;
        data.first_light[i] = static_cast<uint32_t>(count);
        count += scene.meshes[instance.mesh].triangle_count();
        if (count + scene.lights.size() + 1 > kMaxLights) {
            throw Error(ErrorCode::OverLimit, "scene: more than 2^30 lights; an emissive triangle counts as one");
        }
    }
    data.triangles.resize(count);
    for (std::size_t i = 0; i < scene.instances.size(); ++i) {
        if (data.first_light[i] == kNoLight) continue;
        const Instance& instance = scene.instances[i];
        const Mesh& mesh = scene.meshes[instance.mesh];
        const std::vector<Vec2>& uv = mesh.uv[scene.materials[instance.material].emission_texture.uv_set];
        parallel_for(mesh.triangle_count(), 4096, [&](uint64_t primitive) {
            const uint32_t* index = mesh.indices.data() + 3 * primitive;
            const auto world = [&](uint32_t v) {
                return transform_point(moved_to(instance.world_from_local, centre), mesh.positions[v]);
            };
            const auto uv_at = [&](uint32_t v) { return uv.empty() ? Vec2{} : uv[v]; };
            const Vec3 a = world(index[0]);
            data.triangles[data.first_light[i] + primitive] = {a,
                                                               world(index[1]) - a,
                                                               world(index[2]) - a,
                                                               uv_at(index[0]),
                                                               uv_at(index[1]),
                                                               uv_at(index[2]),
                                                               static_cast<uint32_t>(i),
                                                               static_cast<uint32_t>(primitive),
                                                               instance.material};
        });
    }
}

/// Makes near and far lights share the draws by power, but leaves neither under a quarter.
void balance(std::vector<double>& powers, const std::vector<bool>& is_far, std::size_t first_checked) {
    double near_sum = 0, far_sum = 0;
    for (std::size_t i = 0; i < powers.size(); ++i) {
        (i >= first_checked && is_far[i - first_checked] ? far_sum : near_sum) += powers[i];
    }
    if (!(near_sum > 0) || !(far_sum > 0)) return;
    const double share = std::clamp(far_sum / (near_sum + far_sum), 0.25, 0.75);
    const double factor = share / (1 - share) * (near_sum / far_sum);
    for (std::size_t i = first_checked; i < powers.size(); ++i) {
        if (is_far[i - first_checked]) powers[i] *= factor;
    }
}

} // namespace

LightSetData build_light_set(const Scene& scene, const float* linear_from_srgb, Messages& messages, Vec3 centre) {
    LightSetData data;
    for (const Material& material : scene.materials) {
        data.emissions.push_back({is_light(material) ? material.emission : Rgb{}, material.emission_texture});
    }
    add_triangles(scene, centre, data);
    for (const Light& light : scene.lights) {
        data.punctual.push_back({light.kind, light.position - centre, light.direction, light.intensity, light.cos_inner,
                                 light.cos_outer, light.range});
    }
    data.has_environment = scene.environment.has_value();
    if (data.has_environment) data.environment = build_environment_light(*scene.environment, messages);

    const Bounds3 bounds = bounds_of(scene);
    const double radius = bounds.is_empty() ? 1.0 : 0.5 * static_cast<double>(length(bounds.size()));
    const std::vector<TextureImageView> images = views_of_images(scene);
    const Pyramids pyramids = build_pyramids(data, images, linear_from_srgb);

    std::vector<double> powers(data.triangles.size() + data.punctual.size() + (data.has_environment ? 1 : 0));
    std::vector<bool> is_far; // of the lights after the triangles
    parallel_for(data.triangles.size(), 1024,
                 [&](uint64_t i) { powers[i] = triangle_power(data, pyramids, data.triangles[i]); });
    for (std::size_t i = 0; i < data.punctual.size(); ++i) {
        powers[data.triangles.size() + i] = punctual_power(data.punctual[i], radius);
        is_far.push_back(data.punctual[i].kind == LightKind::Directional);
    }
    if (data.has_environment) {
        powers.back() = 4 * kPiDouble * kPiDouble * radius * radius * mean_of_channels(data.environment.mean_radiance);
        is_far.push_back(true);
    }
    balance(powers, is_far, data.triangles.size());

    double largest = 0;
    for (const double power : powers) largest = std::max(largest, power);
    std::vector<float> weights(powers.size());
    for (std::size_t i = 0; i < powers.size(); ++i) {
        weights[i] = largest > 0 ? static_cast<float>(powers[i] / largest) : 0.0f;
    }
    data.choice = build_alias_table(weights);
    return data;
}

uint64_t count_emissive_triangles(const Scene& scene) {
    uint64_t count = 0;
    for (const Instance& instance : scene.instances) {
        if (is_light(scene.materials[instance.material])) count += scene.meshes[instance.mesh].triangle_count();
    }
    return count;
}

LightSetView view_of(const LightSetData& data, const TextureImageView* images, const float* linear_from_srgb) {
    LightSetView view;
    view.choice = view_of(data.choice);
    view.triangles = data.triangles.data();
    view.punctual = data.punctual.data();
    view.triangle_count = static_cast<uint32_t>(data.triangles.size());
    view.punctual_count = static_cast<uint32_t>(data.punctual.size());
    if (data.has_environment) view.environment_light = view.triangle_count + view.punctual_count;
    view.first_light = data.first_light.data();
    view.emissions = data.emissions.data();
    view.images = images;
    view.linear_from_srgb = linear_from_srgb;
    view.environment = view_of(data.environment);
    return view;
}

} // namespace pertev
