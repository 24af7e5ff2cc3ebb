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

void add_triangles(const Scene& scene, LightSetData& data) {
    uint64_t count = 0;
    data.first_light.assign(scene.instances.size(), kNoLight);
    for (std::size_t i = 0; i < scene.instances.size(); ++i) {
        const Instance& instance = scene.instances[i];
        if (!is_light(scene.materials[instance.material])) continue;
        data.first_light[i] = static_cast<uint32_t>(count);
        const uint64_t triangles = scene.meshes[instance.mesh].triangle_count();
        data.emitters.push_back({.first_triangle = static_cast<uint32_t>(count),
                                 .triangle_count = static_cast<uint32_t>(triangles)});
        count += triangles;
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
                return transform_point(instance.world_from_local, mesh.positions[v]);
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

/// Makes near and far sources share the draws by power, but leaves neither under a quarter.
void balance(std::vector<double>& powers, const std::vector<bool>& is_far) {
    double near_sum = 0, far_sum = 0;
    for (std::size_t i = 0; i < powers.size(); ++i) (is_far[i] ? far_sum : near_sum) += powers[i];
    if (!(near_sum > 0) || !(far_sum > 0)) return;
    const double share = std::clamp(far_sum / (near_sum + far_sum), 0.25, 0.75);
    const double factor = share / (1 - share) * (near_sum / far_sum);
    for (std::size_t i = 0; i < powers.size(); ++i) {
        if (is_far[i]) powers[i] *= factor;
    }
}

/// Tables of the emitters, and their powers.
std::vector<double> build_triangle_tables(LightSetData& data, const Pyramids& pyramids) {
    std::size_t guides = 0;
    for (Emitter& emitter : data.emitters) {
        emitter.first_guide = static_cast<uint32_t>(guides);
        emitter.guide_bits = guide_bits_for(emitter.triangle_count);
        guides += (std::size_t(1) << emitter.guide_bits) + 1;
    }
    data.triangle_starts.resize(data.triangles.size() + data.emitters.size());
    data.triangle_guides.resize(guides);

    std::vector<double> triangle_powers(data.triangles.size()), powers(data.emitters.size());
    parallel_for(data.triangles.size(), 1024, [&](uint64_t i) {
        triangle_powers[i] = triangle_power(data, pyramids, data.triangles[i]);
    });
    parallel_for(data.emitters.size(), 16, [&](uint64_t i) {
        const Emitter& emitter = data.emitters[i];
        powers[i] = build_ordered_table(
            std::span<const double>(triangle_powers).subspan(emitter.first_triangle, emitter.triangle_count),
            std::span(data.triangle_starts).subspan(emitter.first_triangle + i, emitter.triangle_count + 1),
            std::span(data.triangle_guides)
                .subspan(emitter.first_guide, (std::size_t(1) << emitter.guide_bits) + 1));
    });
    return powers;
}

/// Every triangle's probability, from the tables' whole numbers.
void store_probabilities(LightSetData& data) {
    if (data.choice.starts.empty()) return;
    for (std::size_t i = 0; i < data.emitters.size(); ++i) {
        const Emitter& emitter = data.emitters[i];
        const double of_source = data.choice.starts[i + 1] - data.choice.starts[i];
        const uint32_t* starts = data.triangle_starts.data() + emitter.first_triangle + i;
        for (uint32_t k = 0; k < emitter.triangle_count; ++k) {
            const double of_triangle = starts[k + 1] - starts[k];
            data.triangles[emitter.first_triangle + k].pmf = static_cast<float>(of_source * of_triangle * 0x1p-62);
        }
    }
}

} // namespace

LightSetData build_light_set(const Scene& scene, const float* linear_from_srgb, Messages& messages) {
    LightSetData data;
    for (const Material& material : scene.materials) {
        data.emissions.push_back({is_light(material) ? material.emission : Rgb{}, material.emission_texture});
    }
    add_triangles(scene, data);
    for (const Light& light : scene.lights) {
        data.punctual.push_back({light.kind, light.position, light.direction, light.intensity, light.cos_inner,
                                 light.cos_outer, light.range});
    }
    data.has_environment = scene.environment.has_value();
    if (data.has_environment) data.environment = build_environment_light(*scene.environment, messages);

    const Bounds3 bounds = bounds_of(scene);
    const double radius = bounds.is_empty() ? 1.0 : 0.5 * static_cast<double>(length(bounds.size()));
    const std::vector<TextureImageView> images = views_of_images(scene);
    const Pyramids pyramids = build_pyramids(data, images, linear_from_srgb);

    std::vector<double> powers = build_triangle_tables(data, pyramids);
    std::vector<bool> is_far(powers.size(), false);
    for (const PunctualLight& light : data.punctual) {
        powers.push_back(punctual_power(light, radius));
        is_far.push_back(light.kind == LightKind::Directional);
    }
    if (data.has_environment) {
        powers.push_back(4 * kPiDouble * kPiDouble * radius * radius *
                         mean_of_channels(data.environment.mean_radiance));
        is_far.push_back(true);
    }
    balance(powers, is_far);
    data.choice = build_ordered_table(powers);
    store_probabilities(data);
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
    view.emitters = data.emitters.data();
    view.triangles = data.triangles.data();
    view.triangle_starts = data.triangle_starts.data();
    view.triangle_guides = data.triangle_guides.data();
    view.punctual = data.punctual.data();
    view.emitter_count = static_cast<uint32_t>(data.emitters.size());
    view.triangle_count = static_cast<uint32_t>(data.triangles.size());
    view.punctual_count = static_cast<uint32_t>(data.punctual.size());
    if (data.has_environment) view.environment_source = view.emitter_count + view.punctual_count;
    view.first_light = data.first_light.data();
    view.emissions = data.emissions.data();
    view.images = images;
    view.linear_from_srgb = linear_from_srgb;
    view.environment = view_of(data.environment);
    return view;
}

} // namespace pertev
