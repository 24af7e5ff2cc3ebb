#include "shading/build_light_set.h"

#include <algorithm>
#include <map>
#include <numeric>
#include <utility>

#include "base/error.h"
#include "base/limits.h"
#include "base/parallel_for.h"
#include "math/double_pi.h"
#include "math/hilbert_curve.h"
#include "math/portable_math.h"
#include "shading/hierarchical_warp.h"
#include "shading/list_tree_lights.h"

namespace pertev {
namespace {

/// Pyramids of the textures of emitters in the scene, one per (image, encoding).
using Pyramids = std::map<std::pair<int32_t, bool>, HierarchicalWarp>;

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
    const double faces = triangle.is_two_sided != 0 ? 2 : 1;
    const double untextured = faces * kPiDouble * area * mean_of_channels(surface.emission);
    const TextureRef& ref = surface.texture;
    if (ref.image == kNoImage) return untextured;
    const HierarchicalWarp& pyramid = pyramids.at({ref.image, ref.is_srgb});
    return untextured * pyramid.mean_over_triangle(ref, triangle.uv0, triangle.uv1, triangle.uv2);
}

double environment_power(const EnvironmentData& environment, double radius) {
    return 4 * kPiDouble * kPiDouble * radius * radius * mean_of_channels(environment.mean_radiance);
}

void add_triangles(const Scene& scene, Vec3 centre, LightSetData& data) {
    uint64_t count = 0;
    data.first_light.assign(scene.instances.size(), kNoLight);
    for (std::size_t i = 0; i < scene.instances.size(); ++i) {
        const Instance& instance = scene.instances[i];
        if (instance.is_hidden || !scene.materials[instance.material].is_emitter()) continue;
        data.first_light[i] = static_cast<uint32_t>(count);
        const uint64_t triangles = scene.meshes[instance.mesh].triangle_count();
        data.emitters.push_back(
            {.first_triangle = static_cast<uint32_t>(count), .triangle_count = static_cast<uint32_t>(triangles)});
        count += triangles;
        if (count + scene.lights.size() + 1 > kMaxLights) {
            throw Error(ErrorCode::OverLimit, "scene", "", "more than 2^30 lights; each emissive triangle is one");
        }
    }
    data.triangles.resize(count);
    for (std::size_t i = 0; i < scene.instances.size(); ++i) {
        if (data.first_light[i] == kNoLight) continue;
        const Instance& instance = scene.instances[i];
        const Mesh& mesh = scene.meshes[instance.mesh];
        const Material& material = scene.materials[instance.material];
        const std::vector<Vec2>& uv = mesh.uv[material.emission_texture.uv_set];
        const bool is_mirrored = is_mirroring(instance.world_from_local);
        parallel_for(mesh.triangle_count(), 4096, [&](uint64_t primitive) {
            const uint32_t* index = mesh.indices.data() + 3 * primitive;
            const auto world = [&](uint32_t v) {
                return transform_point(moved_to(instance.world_from_local, centre), mesh.positions[v]);
            };
            const auto uv_at = [&](uint32_t v) { return uv.empty() ? Vec2{} : uv[v]; };
            const Vec3 a = world(index[0]);
            EmissiveTriangle& triangle = data.triangles[data.first_light[i] + primitive];
            triangle.a = a;
            triangle.ab = world(index[1]) - a;
            triangle.ac = world(index[2]) - a;
            triangle.uv0 = uv_at(index[0]);
            triangle.uv1 = uv_at(index[1]);
            triangle.uv2 = uv_at(index[2]);
            triangle.instance = static_cast<uint32_t>(i) & (kMaxInstances - 1);
            triangle.is_mirrored = is_mirrored ? 1 : 0;
            triangle.is_two_sided = material.two_sided_emission ? 1 : 0;
            triangle.primitive = static_cast<uint32_t>(primitive);
            triangle.material = instance.material;
        });
    }
}

void add_punctual_lights(const Scene& scene, Vec3 centre, LightSetData& data) {
    std::map<const IntensityTable*, uint32_t> first_with; // the number of the first light with a table
    for (const Light& light : scene.lights) {
        PunctualLight punctual = {light.kind,      light.position - centre, light.direction, shown_intensity(light),
                                  light.cos_inner, light.cos_outer,         light.range};
        punctual.number = static_cast<uint32_t>(data.punctual.size());
        if (parts_of(light.kind).table) {
            punctual.table = static_cast<uint32_t>(data.goniometric.tables.size());
            const auto [entry, is_new] = first_with.try_emplace(light.table.get(), punctual.table);
            punctual.cos_outer = data.goniometric.add(light, entry->second);
        }
        data.punctual.push_back(punctual);
    }
}

Vec3 middle_of(const EmissiveTriangle& triangle) { return triangle.a + (triangle.ab + triangle.ac) / 3.0f; }

/// A line along which points lie, and whether they do.
struct Row {
    Vec3 middle, along; // `along` is not unit
    bool is_straight = false;
};

/// Finds a line from the middle of the points to the farthest one; it counts if they lie within a quarter of their
/// spread from it.
Row find_row(std::span<const Vec3> points) {
    Row row;
    double sum[3] = {};
    for (const Vec3 p : points) {
        sum[0] += static_cast<double>(p.x), sum[1] += static_cast<double>(p.y), sum[2] += static_cast<double>(p.z);
    }
    const double n = static_cast<double>(std::max<std::size_t>(points.size(), 1));
    row.middle = {static_cast<float>(sum[0] / n), static_cast<float>(sum[1] / n), static_cast<float>(sum[2] / n)};
    for (const Vec3 p : points) {
        if (length_squared(p - row.middle) > length_squared(row.along)) row.along = p - row.middle;
    }
    double spread = 0, beside = 0;
    for (const Vec3 p : points) {
        const double whole = static_cast<double>(length_squared(p - row.middle));
        const double across = static_cast<double>(length_squared(cross(row.along, p - row.middle)));
        spread += whole;
        beside += across / std::max(static_cast<double>(length_squared(row.along)), 1e-300);
    }
    row.is_straight = 16 * beside <= spread;
    return row;
}

/// Sorts indices [0, n) spatially, so that an even split of a table splits space: along a line if the points lie on
/// one, else along Hilbert's curve.
std::vector<uint32_t> order_in_space(std::span<const Vec3> points) {
    std::vector<uint32_t> order(points.size());
    std::iota(order.begin(), order.end(), 0u);
    if (const Row row = find_row(points); row.is_straight) {
        std::vector<float> keys(points.size());
        for (std::size_t i = 0; i < points.size(); ++i) keys[i] = dot(points[i] - row.middle, row.along);
        std::ranges::stable_sort(order, {}, [&](uint32_t i) { return keys[i]; });
        return order;
    }
    Bounds3 bounds;
    for (const Vec3 point : points) bounds.extend(point);
    std::vector<uint32_t> positions(points.size());
    parallel_for(points.size(), 4096, [&](uint64_t i) { positions[i] = hilbert_position(points[i], bounds); });
    std::ranges::stable_sort(order, {}, [&](uint32_t i) { return positions[i]; });
    return order;
}

/// Sorts emitters and the triangles in their tables spatially.
void order_emitters(LightSetData& data) {
    data.triangle_order.resize(data.triangles.size());
    std::vector<Vec3> middles;
    for (const Emitter& emitter : data.emitters) {
        const auto triangles =
            std::span<const EmissiveTriangle>(data.triangles).subspan(emitter.first_triangle, emitter.triangle_count);
        std::vector<Vec3> points(triangles.size());
        std::ranges::transform(triangles, points.begin(), middle_of);
        std::ranges::copy(order_in_space(points), data.triangle_order.begin() + emitter.first_triangle);
        Bounds3 bounds;
        for (const Vec3 point : points) bounds.extend(point);
        middles.push_back(bounds.is_empty() ? Vec3{} : bounds.centre());
    }
    std::vector<Emitter> ordered;
    for (const uint32_t i : order_in_space(middles)) ordered.push_back(data.emitters[i]);
    data.emitters = std::move(ordered);
}

/// Sorts punctual lights spatially, those without a position last.
void order_punctual_lights(LightSetData& data) {
    const auto first_far = std::ranges::stable_partition(
        data.punctual, [](const PunctualLight& light) { return parts_of(light.kind).position; });
    std::vector<Vec3> positions;
    for (auto light = data.punctual.begin(); light != first_far.begin(); ++light) positions.push_back(light->position);
    std::vector<PunctualLight> ordered;
    for (const uint32_t i : order_in_space(positions)) ordered.push_back(data.punctual[i]);
    std::ranges::copy(ordered, data.punctual.begin());
}

std::vector<double> triangle_powers(const LightSetData& data, const Pyramids& pyramids) {
    std::vector<double> powers(data.triangles.size());
    parallel_for(powers.size(), 1024,
                 [&](uint64_t i) { powers[i] = triangle_power(data, pyramids, data.triangles[i]); });
    return powers;
}

/// Builds the tables of the emitters in their order and returns their powers.
std::vector<double> build_triangle_tables(LightSetData& data, std::span<const double> of_triangles) {
    std::size_t starts = 0, guides = 0;
    for (Emitter& emitter : data.emitters) {
        emitter.first_start = static_cast<uint32_t>(starts);
        starts += emitter.triangle_count + 1;
        emitter.first_guide = static_cast<uint32_t>(guides);
        emitter.guide_bits = guide_bits_for(emitter.triangle_count);
        guides += (std::size_t(1) << emitter.guide_bits) + 1;
    }
    data.triangle_starts.resize(starts);
    data.triangle_guides.resize(guides);

    std::vector<double> powers(data.emitters.size());
    parallel_for(data.emitters.size(), 16, [&](uint64_t i) {
        const Emitter& emitter = data.emitters[i];
        std::vector<double> in_order(emitter.triangle_count);
        for (uint32_t k = 0; k < emitter.triangle_count; ++k) {
            in_order[k] = of_triangles[emitter.first_triangle + data.triangle_order[emitter.first_triangle + k]];
        }
        powers[i] = build_guided_cdf(
            in_order, std::span(data.triangle_starts).subspan(emitter.first_start, emitter.triangle_count + 1),
            std::span(data.triangle_guides).subspan(emitter.first_guide, (std::size_t(1) << emitter.guide_bits) + 1));
    });
    return powers;
}

/// Stores every triangle's probability, from the tables' integers.
void store_probabilities(LightSetData& data) {
    if (data.choice.starts.empty()) return;
    for (std::size_t i = 0; i < data.emitters.size(); ++i) {
        const Emitter& emitter = data.emitters[i];
        const double of_source = data.choice.starts[i + 1] - data.choice.starts[i];
        const uint32_t* starts = data.triangle_starts.data() + emitter.first_start;
        for (uint32_t k = 0; k < emitter.triangle_count; ++k) {
            const double of_triangle = starts[k + 1] - starts[k];
            data.triangles[emitter.first_triangle + data.triangle_order[emitter.first_triangle + k]].pmf =
                static_cast<float>(of_source * of_triangle * 0x1p-62);
        }
    }
}

} // namespace

LightSetData build_light_set(const Scene& scene, const float* linear_from_srgb, Sink& sink, Vec3 centre,
                             std::shared_ptr<const EnvironmentData> environment) {
    LightSetData data;
    for (const Material& material : scene.materials) {
        data.emissions.push_back({material.is_emitter() ? material.emission : Rgb{}, material.emission_texture});
        SurfaceEmission& surface = data.emissions.back();
        if (!material.has_coat() || !material.is_emitter()) continue;
        surface.coat_weight = material.coat_weight;
        surface.coat_roughness = material.coat_roughness;
        surface.coat_color = material.coat_color;
        surface.coat_f0 = f0_from_ior(material.coat_ior);
        const uint8_t set = material.emission_texture.uv_set; // triangles of emitters have no other
        const auto use = [&](const TextureRef& from, TextureRef& to) {
            if (from.uv_set == set) to = from;
        };
        use(material.coat_texture, surface.coat_texture);
        use(material.coat_roughness_texture, surface.coat_roughness_texture);
        use(material.coat_color_texture, surface.coat_color_texture);
    }
    add_triangles(scene, centre, data);
    add_punctual_lights(scene, centre, data);
    if (scene.environment) {
        if (environment == nullptr) {
            environment = std::make_shared<const EnvironmentData>(build_environment_light(*scene.environment, sink));
        }
        data.environment = std::move(environment);
    }

    const Bounds3 bounds = bounds_of(scene);
    const double radius = bounds.is_empty() ? 1.0 : 0.5 * static_cast<double>(length(bounds.size()));
    const std::vector<TextureImageView> images = views_of_images(scene);
    const Pyramids pyramids = build_pyramids(data, images, linear_from_srgb);

    order_emitters(data);
    order_punctual_lights(data);
    const std::vector<double> of_triangles = triangle_powers(data, pyramids);
    data.source_powers = build_triangle_tables(data, of_triangles);
    const auto add_source = [&](double power, bool is_far) {
        data.source_powers.push_back(power);
        if (!is_far) data.near_count = static_cast<uint32_t>(data.source_powers.size());
    };
    data.near_count = static_cast<uint32_t>(data.source_powers.size());
    for (const PunctualLight& light : data.punctual) {
        const double power = punctual_power(scene.lights[light.number], mean_of_channels(light.intensity), radius);
        add_source(power, !parts_of(light.kind).position);
    }
    if (data.environment) add_source(environment_power(*data.environment, radius), true);
    const auto of_punctual = std::span<const double>(data.source_powers)
                                 .subspan(data.emitters.size(), data.near_count - data.emitters.size());
    data.tree =
        std::make_shared<const RequestedLightTree>(list_tree_lights(scene, centre, data, of_triangles, of_punctual));
    share_draws(data, kEvenShare);
    return data;
}

bool LightSetData::has_both_kinds() const {
    const auto is_light = [](double power) { return power > 0; };
    const auto first_far = source_powers.begin() + near_count;
    return std::any_of(source_powers.begin(), first_far, is_light) &&
           std::any_of(first_far, source_powers.end(), is_light);
}

void share_draws(LightSetData& data, double far_share) {
    std::vector<double> weights = data.source_powers;
    if (data.has_both_kinds()) {
        const auto first_far = weights.begin() + data.near_count;
        const double near_sum = std::accumulate(weights.begin(), first_far, 0.0);
        const double far_sum = std::accumulate(first_far, weights.end(), 0.0);
        for (auto weight = weights.begin(); weight != first_far; ++weight) *weight *= (1 - far_share) / near_sum;
        for (auto weight = first_far; weight != weights.end(); ++weight) *weight *= far_share / far_sum;
    }
    data.choice = build_guided_cdf(weights);
    store_probabilities(data);
}

uint64_t count_emissive_triangles(const Scene& scene) {
    uint64_t count = 0;
    for (const Instance& instance : scene.instances) {
        if (!instance.is_hidden && scene.materials[instance.material].is_emitter())
            count += scene.meshes[instance.mesh].triangle_count();
    }
    return count;
}

LightSetView view_of(const LightSetData& data, const TextureImageView* images, const float* linear_from_srgb) {
    LightSetView view;
    view.choice = view_of(data.choice);
    visit_arrays(data, view, [](const auto& array, auto& pointer) { pointer = array.data(); });
    view.emitter_count = static_cast<uint32_t>(data.emitters.size());
    view.triangle_count = static_cast<uint32_t>(data.triangles.size());
    view.punctual_count = static_cast<uint32_t>(data.punctual.size());
    view.near_count = data.near_count;
    if (data.tree != nullptr) view.tree = data.tree->is_built() ? data.tree->get().view() : LightTreeView{};
    if (data.tree != nullptr) view.tree.light_count = data.tree->light_count();
    if (data.environment) view.environment_source = view.emitter_count + view.punctual_count;
    view.images = images;
    view.linear_from_srgb = linear_from_srgb;
    if (data.environment) view.environment = view_of(*data.environment);
    return view;
}

} // namespace pertev
