// Vertices shaded in eight or sixteen lanes have the bits of shade_vertex for each single path: emission, the shadow
// ray with its direct light, and the scattered path.

#include <vector>

#include <doctest/doctest.h>

#include "device_scene/scene_on_device.h"
#include "integrators/path/path_code.h"
#include "integrators/path/path_vertex.h"
#include "integrators/path/shade_lanes.h"
#include "render/prepare_scene.h"
#include "tests/support/flat_scenes.h"
#include "tests/support/random.h"

using namespace pertev;

namespace {

constexpr uint32_t kTriangles = 8, kMaxDepth = 4;

/// Triangles at random positions, including thin ones. Their vertex normals, if any, differ, are opposite or zero.
Mesh scattered_triangles(test::Random& random, bool has_normals) {
    Mesh mesh;
    for (uint32_t i = 0; i < 3 * kTriangles; ++i) {
        const bool is_thin = i % 3 == 2 && random.below(4) == 0;
        mesh.positions.push_back(is_thin ? mesh.positions.back() + random.point(-1e-4f, 1e-4f) : random.point(-1, 1));
        mesh.indices.push_back(i);
        if (has_normals) mesh.normals.push_back(random.below(8) == 0 ? Vec3{0, 0, 0} : random.direction());
        const auto channel = [&] { return random.below(4) == 0 ? 0.0f : random.unit(); };
        const float red = channel(), green = channel();
        if (has_normals) mesh.colors.push_back({red, green, channel(), 1});
        mesh.uv[0].push_back({2 * random.unit(), random.unit()});
    }
    return mesh;
}

/// Smooth and flat triangles, baked and instanced, mirrored or not, with each material: white, black, grey, and one-
/// and two-sided emitters.
Scene scattered_scene(test::Random& random, const std::optional<Environment>& environment) {
    Scene scene;
    scene.bakes_small_meshes = false; // so that there are instances
    scene.materials = {test::white(1), test::white(0), test::white(0.4f), test::white(0.3f), test::white(0)};
    scene.materials[3].emission = {3, 0, 1}, scene.materials[4].emission = {0.5f, 2, 0};
    scene.materials[4].two_sided_emission = true;
    scene.meshes = {scattered_triangles(random, true), scattered_triangles(random, false)};
    const auto place = [&](uint32_t mesh, uint32_t material, float scale) {
        Transform placed;
        placed.row0.x = scale, placed.row1.z = 0.3f * scale, placed.translation = random.point(-3, 3);
        scene.instances.push_back({"", mesh, material, placed});
    };
    for (uint32_t material = 0; material < scene.materials.size(); ++material) {
        for (const uint32_t mesh : {0u, 1u}) place(mesh, material, mesh == 0 ? -1.5f : 2.0f);
    }
    scene.meshes.push_back(scattered_triangles(random, true)); // a mesh that is used once is baked
    place(2, 2, -1.0f);
    scene.lights = {test::point_light({0, 4, 0}, {9, 3, 5}), test::point_light({2, 1, 1}, {5, 5, 5})};
    scene.lights[1].kind = LightKind::Spot, scene.lights[1].cos_outer = 0.1f;
    scene.lights.push_back({.kind = LightKind::Directional, .direction = {0.6f, -0.8f, 0}});
    scene.environment = environment;
    return scene;
}

/// Adds to scattered_scene() a texture of the grey material's colour, normal maps with and without tangents,
/// reflections of several widths, shares of metal and textures, and materials that lanes do not shade: a metal of a
/// complex index, a coat on white, rough diffuse, an unlit one and smooth plastic.
Scene mixed_scene(test::Random& random, const std::optional<Environment>& environment) {
    Scene scene = scattered_scene(random, environment);
    scene.images.resize(2);
    scene.images[0].rgba8 = {2, 2, {255, 0, 9, 255, 20, 90, 255, 255, 0, 0, 0, 255, 77, 255, 3, 255}};
    scene.images[1].rgba8 = {2, 1, {128, 90, 255, 255, 255, 10, 140, 255}};
    TextureRef color;
    color.image = 0, color.m00 = 0.5f, color.m01 = 0.25f;
    scene.materials[2].base_color_texture = color;
    scene.materials[3].emission_texture =
        color; // one- and two-sided emitters, of which the latter has a coat and holes
    scene.materials[4].coat_weight = 0.5f, scene.materials[4].coat_color = {0.9f, 0.5f, 0.1f};
    scene.materials[4].alpha_mode = AlphaMode::Blend, scene.materials[4].alpha = 0.5f;
    float greatest = 0;
    scene.lights[0].kind = LightKind::Goniometric;
    scene.lights[0].table =
        make_intensity_table(make_round_table(kPi, [](float angle) { return 4 - angle; }), greatest);
    for (const bool has_tangents : {false, true}) {
        for (const uint32_t mesh : {0u, 1u}) {
            scene.materials.push_back(test::white(0.7f));
            Material& bumpy = scene.materials.back();
            bumpy.normal_texture = color, bumpy.normal_texture.image = 1;
            if (mesh == 1) bumpy.normal_texture.m00 = -0.5f;
            bumpy.normal_scale = has_tangents ? 0.7f : -1.5f;
            scene.meshes.push_back(scene.meshes[mesh]);
            Mesh& with_tangents = scene.meshes.back();
            for (std::size_t i = 0; has_tangents && i < with_tangents.positions.size(); ++i) {
                const Vec3 t = random.below(8) == 0 ? Vec3{0, 0, 0} : 3.0f * random.direction();
                with_tangents.tangents.push_back({t.x, t.y, t.z, i % 6 < 3 ? 1.0f : -1.0f});
            }
            scene.instances.push_back({"",
                                       static_cast<uint32_t>(scene.meshes.size() - 1),
                                       static_cast<uint32_t>(scene.materials.size() - 1),
                                       {}});
            scene.instances.back().world_from_local.row0.x = mesh == 1 ? -2.0f : 1.0f;
            scene.instances.push_back(scene.instances.back());
            scene.instances.back().world_from_local.translation = {0.5f, 0, 1};
        }
    }
    for (const float metallic : {0.0f, 0.4f, 1.0f}) {
        for (const float roughness : {0.05f, 0.3f, 1.0f}) {
            Material glossy = test::white(metallic == 0.4f && roughness == 0.3f ? 0 : 0.8f);
            glossy.kind = MaterialKind::MetallicRoughness;
            glossy.base_color.g = 0.3f * glossy.base_color.r;
            glossy.metallic = metallic, glossy.roughness = roughness, glossy.ior = 1.1f + roughness;
            if (metallic == 0.4f) glossy.metallic_texture = color;
            if (roughness == 1) glossy.roughness_texture = color, glossy.roughness_texture.channel = 2;
            if (roughness == 0.3f) glossy.normal_texture = color, glossy.normal_texture.image = 1;
            if (metallic == 1 && roughness == 1) glossy.emission = {1, 2, 3};
            scene.materials.push_back(glossy);
            for (const uint32_t mesh : {0u, 1u})
                scene.instances.push_back({"", mesh, static_cast<uint32_t>(scene.materials.size() - 1), {}});
        }
    }
    const auto first = static_cast<uint32_t>(scene.materials.size());
    for (int i = 0; i < 5; ++i) scene.materials.push_back(test::white(0.5f));
    scene.materials[first].kind = MaterialKind::Conductor;
    scene.materials[first + 1].coat_weight = 1;
    scene.materials[first + 2].base_diffuse_roughness = 0.5f;
    scene.materials[first + 3].kind = MaterialKind::Unlit;
    scene.materials[first + 4].kind = MaterialKind::MetallicRoughness;
    scene.materials[first + 4].roughness = 0;
    for (uint32_t i = 0; i < 5; ++i) scene.instances.push_back({"", i % 2, first + i, {}});
    return scene;
}

/// Adds to mixed_scene() panes between all that it has: clear, red and black.
Scene scene_with_panes(test::Random& random, const std::optional<Environment>& environment) {
    Scene scene = mixed_scene(random, environment);
    const Rgb colors[] = {{1, 1, 1}, {0.9f, 0.2f, 0}, {0, 0, 0}};
    for (int i = 0; i < 3; ++i) {
        Material pane = test::white();
        pane.kind = MaterialKind::MetallicRoughness, pane.metallic = 0, pane.roughness = 0;
        pane.transmission_weight = 1, pane.thin_walled = true, pane.base_color = colors[i];
        const auto x = static_cast<float>(i);
        test::add(scene, test::sheet({x - 1, 0.5f * x, -x}, {1, 0, 1}, {0, 1, 0.25f * x}), pane);
    }
    return scene;
}

struct PreparedJob {
    Scene scene;
    Messages messages;
    Queue queue = Queue::make_cpu();
    PreparedScene prepared;
    SceneOnDevice device;
    PathJob job = {};

    explicit PreparedJob(Scene s)
        : scene(std::move(s)), prepared(prepare_scene(scene, {}, messages)), device(queue, prepared) {
        job.picture.scene = device.view();
        job.passes_thin_walls = device.view().thin_walls.is_there();
    }
};

/// Draws a path and its hit with lobes that lanes shade: inside triangles, on edges and at corners, with perpendicular,
/// grazing and tangential rays.
void draw_vertex_of(test::Random& random, const SceneView& scene, LaneLobes lobes, PathState& path, Hit& hit) {
    do {
        hit = {.t = random.within(0.1f, 5), .instance = random.below(scene.instance_count), .primitive = {}};
        hit.primitive = random.below(kTriangles);
        hit.u = random.below(4) == 0 ? 0.5f * static_cast<float>(random.below(3)) : random.unit();
        hit.v = random.below(4) == 0 ? 0.0f : (1 - hit.u) * random.unit();
    } while (scene.instances[hit.instance].is_thin_wall != 0 || lane_lobes(scene, {}, hit) != lobes);
    const InstanceView& instance = scene.instances[hit.instance];
    const WorldTriangle triangle = world_triangle(instance, scene.meshes[instance.mesh], hit);
    const uint32_t way = random.below(6);
    path = {};
    path.direction = random.direction();
    if (way == 0) path.direction = -triangle.normal;
    if (way == 1) path.direction = normalize(triangle.ab + 1e-5f * random.direction());
    if (way == 2) path.direction = normalize(triangle.ab);
    path.origin = triangle.position - hit.t * path.direction;
    path.depth = random.below(kMaxDepth + 2);
    path.rough_depth = random.below(path.depth + 1);
    const float throughputs[] = {0, 1, 1e-30f, 1e6f, random.unit(), random.unit()};
    for (float* channel : {&path.throughput.r, &path.throughput.g, &path.throughput.b}) {
        *channel = throughputs[random.below(6)];
    }
    path.radiance = {random.unit(), 0, random.unit()};
    const float densities[] = {0, 1e-30f, 1e30f, random.unit(), 4 * random.unit()}; // 0: camera, or delta lobe
    path.bsdf_pdf = densities[random.below(5)];
    path.passed = random.below(3) == 0 ? random.unit() : 0.0f;
    path.pixel = random.below(1u << 20), path.sample = random.below(1u << random.below(20));
}

/// Returns whether both have the same bits or are NaN, whose bits may differ.
bool is_same(float a, float b) { return bits_of(a) == bits_of(b) || (a != a && b != b); }
bool is_same(Vec3 a, Vec3 b) { return is_same(a.x, b.x) && is_same(a.y, b.y) && is_same(a.z, b.z); }
bool is_same(Rgb a, Rgb b) { return is_same(Vec3{a.r, a.g, a.b}, Vec3{b.r, b.g, b.b}); }
bool is_same(TriangleId a, TriangleId b) { return a.instance == b.instance && a.primitive == b.primitive; }

/// Counts the events at vertices, because all kinds must occur.
struct Counts {
    uint32_t went_on = 0, ended_early = 0, shadows = 0, to_triangles = 0, without_end = 0, emitted = 0;
    uint32_t behind_panes = 0;
};

/// Shades `count` random vertices in lanes and one by one.
template <Features kFeatures>
void check_vertices(const VertexShading& shading, LaneLobes lobes, const PathJob& job, test::Random& random,
                    uint32_t count, Counts& counts) {
    PathState before[kMaxLanes], paths[kMaxLanes];
    Hit hits[kMaxLanes];
    ShadowRay shadows[kMaxLanes];
    LaneVertices vertices = {.count = count, .paths = {}, .hits = {}};
    for (uint32_t lane = 0; lane < shading.lanes; ++lane) {
        if (lane < count) draw_vertex_of(random, job.picture.scene, lobes, before[lane], hits[lane]);
        paths[lane] = before[lane];
        const uint32_t from = min(lane, count - 1);
        vertices.paths[lane] = paths + from, vertices.hits[lane] = hits + from;
    }
    const auto shade = lobes == LaneLobes::Diffuse ? shading.shade_diffuse : shading.shade_glossy;
    const LaneResults results = shade(job, vertices, shadows);
    CHECK((results.goes_on | results.has_shadow_ray) < 1u << count);
    const ShadowRay* shadow = shadows;
    for (uint32_t lane = 0; lane < count; ++lane) {
        PathState path = before[lane];
        ShadowRay expected;
        bool has_shadow_ray = false;
        Listeners<> nobody(job);
        const bool goes_on =
            shade_vertex<kFeatures>(job, path, hits[lane], DrawOnDemand(), expected, has_shadow_ray, nobody);
        CAPTURE(lane);
        CAPTURE(path.depth);
        CHECK(is_same(paths[lane].radiance, path.radiance));
        REQUIRE(((results.has_shadow_ray >> lane & 1) != 0) == has_shadow_ray);
        CHECK(((results.goes_on >> lane & 1) != 0) == goes_on);
        counts.emitted += path.radiance == before[lane].radiance ? 0 : 1;
        counts.ended_early += !goes_on && before[lane].depth < kMaxDepth ? 1 : 0;
        if (goes_on) {
            ++counts.went_on;
            CHECK(is_same(paths[lane].origin, path.origin));
            CHECK(is_same(paths[lane].direction, path.direction));
            CHECK(is_same(paths[lane].throughput, path.throughput));
            CHECK(is_same(paths[lane].bsdf_pdf, path.bsdf_pdf));
            CHECK((!job.passes_thin_walls || is_same(paths[lane].passed, path.passed)));
            CHECK(is_same(paths[lane].start, path.start));
            CHECK(paths[lane].depth == path.depth);
            CHECK(paths[lane].rough_depth == path.rough_depth);
        }
        if (!has_shadow_ray) continue;
        ++counts.shadows;
        const Ray ray = {expected.origin, 0, expected.direction, expected.t_max};
        if (job.passes_thin_walls) counts.behind_panes += pass_thin_walls(job.picture.scene, ray).count != 0 ? 1 : 0;
        counts.to_triangles += expected.target.instance == kNoLight ? 0 : 1;
        counts.without_end += expected.t_max == kInfinity ? 1 : 0;
        CHECK(is_same(shadow->origin, expected.origin));
        CHECK(is_same(shadow->direction, expected.direction));
        CHECK(is_same(shadow->t_max, expected.t_max));
        CHECK(is_same(shadow->start, expected.start));
        CHECK(is_same(shadow->target, expected.target));
        CHECK(is_same(shadow->contribution, expected.contribution));
        ++shadow;
    }
}

std::vector<PathSettings> settings_of_tests() {
    std::vector<PathSettings> settings(5, PathSettings{.max_depth = kMaxDepth});
    settings[1].clamp = 0.2f, settings[1].roulette = Roulette::Throughput, settings[1].roulette_depth = 1;
    settings[2].sampler = SamplerKind::Independent, settings[2].roulette = Roulette::NearCubeRoot;
    settings[3].roulette_depth = 100, settings[3].seed = 5;
    settings[4].strategy = LightStrategy::NeeOnly;
    return settings;
}

template <Features kFeatures>
void check_all_vertices(const VertexShading& shading, LaneLobes lobes = LaneLobes::Diffuse) {
    test::Random random(7);
    Environment panorama;
    panorama.image = {4, 2, 3, {}};
    for (uint32_t i = 0; i < 24; ++i) panorama.image.pixels.push_back(i % 5 == 0 ? 0.0f : random.unit());
    Counts counts;
    for (const std::optional<Environment>& environment :
         {std::optional<Environment>{}, std::optional{Environment{{}, {0.3f, 0.4f, 0.6f}, 1.0f}},
          std::optional{Environment{{}, {0, 0, 0}, 0}}, std::optional{panorama}}) {
        const auto make_scene = kFeatures == kPlainDiffuse  ? scattered_scene
                                : (kFeatures & kMedia) != 0 ? scene_with_panes
                                                            : mixed_scene;
        PreparedJob of(make_scene(random, environment));
        CHECK(features_for(of.job) == kFeatures);
        for (const PathSettings& settings : settings_of_tests()) {
            of.job.settings = settings;
            of.job.ends_by_nee = settings.strategy == LightStrategy::NeeOnly;
            REQUIRE(can_shade_lanes(of.job));
            for (uint32_t round = 0; round < 60; ++round) {
                check_vertices<kFeatures>(shading, lobes, of.job, random, 1 + round % shading.lanes, counts);
                check_vertices<kFeatures>(shading, lobes, of.job, random, shading.lanes, counts);
            }
        }
    }
    for (const uint32_t some : {counts.went_on, counts.ended_early, counts.shadows, counts.to_triangles,
                                counts.without_end, counts.emitted}) {
        CHECK(some > 200);
    }
    CHECK((counts.behind_panes > 200) == ((kFeatures & kMedia) != 0));
}

constexpr Features kWithPanes = kAllMaterials | kMedia;

} // namespace

TEST_CASE("shade lanes: eight vertices have the bits of single ones") {
    check_all_vertices<kPlainDiffuse>(kShadingOf8);
    check_all_vertices<kAllMaterials>(kShadingOf8);
    check_all_vertices<kAllMaterials>(kShadingOf8, LaneLobes::Glossy);
    check_all_vertices<kWithPanes>(kShadingOf8);
    check_all_vertices<kWithPanes>(kShadingOf8, LaneLobes::Glossy);
}

#if defined(PERTEV_HAS_16_LANES)
TEST_CASE("shade lanes: sixteen vertices have the bits of single ones") {
    if (!has_sixteen_lanes()) return;
    check_all_vertices<kPlainDiffuse>(kShadingOf16);
    check_all_vertices<kAllMaterials>(kShadingOf16);
    check_all_vertices<kAllMaterials>(kShadingOf16, LaneLobes::Glossy);
    check_all_vertices<kWithPanes>(kShadingOf16);
    check_all_vertices<kWithPanes>(kShadingOf16, LaneLobes::Glossy);
}
#endif

TEST_CASE("shade lanes: vertices are single where solids absorb on the way") {
    test::Random random(3);
    Scene scene = mixed_scene(random, {});
    scene.materials.push_back({{.kind = MaterialKind::Dielectric}, "glass"});
    scene.materials.back().transmission_depth = 1;
    const auto glass = static_cast<uint32_t>(scene.instances.size());
    scene.instances.push_back({"", 0, static_cast<uint32_t>(scene.materials.size() - 1), {}});
    Scene glowing = scene;
    glowing.materials.back().emission = {1, 1, 1};
    CHECK(!can_shade_lanes(PreparedJob(std::move(glowing)).job));
    const PreparedJob of(std::move(scene));
    CHECK(can_shade_lanes(of.job));
    const SceneView& view = of.job.picture.scene;
    PathState path = {};
    path.start = {kNoHit, kNoHit};
    const Hit hit = {.t = 1, .u = 0.25f, .v = 0.25f, .instance = 0, .primitive = 0};
    CHECK(lane_lobes(view, path, hit) == LaneLobes::Diffuse);
    path.start = {glass, 0};
    CHECK(lane_lobes(view, path, hit) == LaneLobes::None);
    path.start = {1, 0};
    CHECK(lane_lobes(view, path, hit) == LaneLobes::Diffuse);
    path.interior = path.interior.with(3);
    CHECK(lane_lobes(view, path, hit) == LaneLobes::None);
}
