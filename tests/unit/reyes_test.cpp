// Reyes: coverage and depth of micropolygons, no cracks between neighbours, displacement, shading and hiding.

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <memory>
#include <set>
#include <utility>
#include <vector>

#include "base/parallel_for.h"
#include "integrators/reyes/split_stages.h"
#include "session/check_integrator.h"
#include "session/session.h"
#include "session/session_bytes.h"
#include "tests/support/flat_scenes.h"
#include "tests/support/meshes.h"
#include "tests/support/options.h"
#include "tests/support/random.h"
#include "tests/support/render_scenes.h"
#include "tests/support/thrown_error.h"

using namespace pertev;

namespace {

RenderSettings reyes_settings(uint32_t width, uint32_t height) {
    RenderSettings settings;
    settings.width = width;
    settings.height = height;
    settings.samples = 1;
    settings.integrator = IntegratorKind::Reyes;
    return settings;
}

Camera looking(Vec3 eye, Vec3 target, Vec3 up = {0, 1, 0}) {
    Camera camera;
    camera.world_from_camera = look_at(eye, target, up);
    return camera;
}

Camera without_perspective(Camera camera, float height) {
    camera.projection = Projection::Orthographic;
    camera.ortho_height = height;
    return camera;
}

/// Displaces material 0 by random texels.
std::shared_ptr<const HeightMaps> random_heights(float scale, uint32_t materials = 1) {
    test::Random random(5);
    HeightMaps maps;
    for (uint32_t i = 0; i < materials; ++i) {
        HeightMap map = {i, {.width = 16, .height = 16, .channels = 1, .pixels = {}}, scale, 0.5f};
        for (int k = 0; k < 256; ++k) map.heights.pixels.push_back(random.within(0, 1));
        maps.push_back(map);
    }
    return std::make_shared<const HeightMaps>(maps);
}

/// A sphere of radius 1 with shared vertices, normals and continuous texture coordinates.
Mesh seamless_sphere() {
    const test::TriangleMesh sphere = test::make_sphere(2, {0, 0, 0}, 1);
    Mesh mesh;
    mesh.positions = sphere.positions;
    mesh.indices = sphere.indices;
    for (const Vec3& p : mesh.positions) {
        mesh.normals.push_back(normalize(p));
        mesh.uv[0].push_back({0.7f * p.x + 0.2f * p.z, 0.6f * p.y + 0.3f * p.z});
    }
    return mesh;
}

Scene scene_of(Mesh mesh) {
    Scene scene;
    test::add(scene, std::move(mesh), test::white(0.5f));
    return scene;
}

/// One untransformed mesh in the form that stages use.
struct HostMesh {
    Mesh mesh;
    MeshView mesh_view{};
    InstanceView instance{};
    uint32_t first_triangle[2] = {};
    SceneView scene{};
    std::vector<DisplacementView> displacement;

    HostMesh(Mesh of, const HeightMap* map) : mesh(std::move(of)) {
        mesh_view.positions = mesh.positions.data();
        mesh_view.normals = mesh.normals.empty() ? nullptr : mesh.normals.data();
        mesh_view.uv[0] = mesh.uv[0].empty() ? nullptr : mesh.uv[0].data();
        mesh_view.indices = mesh.indices.data();
        first_triangle[1] = static_cast<uint32_t>(mesh.indices.size() / 3);
        scene.meshes = &mesh_view;
        scene.instances = &instance;
        scene.instance_count = 1;
        scene.triangle_count = first_triangle[1];
        scene.first_triangle = first_triangle;
        if (map != nullptr)
            displacement.push_back({map->heights.pixels.data(), 16, 16, map->scale, map->middle, 0.5f * map->scale});
    }
};

using ScreenPoint = std::array<double, 3>;
using Edge = std::pair<ScreenPoint, ScreenPoint>;

struct Diced {
    std::map<Edge, int> edges; // number of micropolygons at each edge
    std::set<std::pair<uint32_t, uint64_t>> split_paths;
    std::size_t count = 0;
    double longest = 0; // pixels
};

/// Returns all micropolygons of a mesh that are in the picture.
Diced dice(const HostMesh& host, const Camera& camera, uint32_t width, uint32_t height, double rate) {
    ReyesPass pass = {};
    pass.camera = make_pinhole(make_camera_rays(camera, {PixelFilter::Box, 0.5f, nullptr}, width, height, {0, 0, 0}));
    pass.picture.scene = host.scene;
    pass.displacements = {host.displacement.data(), static_cast<uint32_t>(host.displacement.size())};
    pass.rate = rate;
    std::vector<Piece> stack;
    for (uint32_t i = 0; i < host.scene.triangle_count; ++i) stack.push_back(whole_triangle(i));
    Diced diced;
    while (!stack.empty()) {
        const Piece piece = stack.back();
        stack.pop_back();
        DicedTriangle triangle;
        REQUIRE(triangle.begin(pass.camera, pass.picture.scene, pass.displacements, piece.triangle));
        DicedPoint p[3];
        for (int k = 0; k < 3; ++k) p[k] = triangle.point(pass.camera.is_perspective, piece.corners[k]);
        if (triangle.is_outside(pass.camera, p)) continue;
        const uint32_t edges = long_edges(pass, triangle, p);
        for (uint32_t k = 0; k < child_count(edges); ++k) stack.push_back(child_of(piece, edges, k));
        if (edges != 0) continue;
        ++diced.count;
        diced.split_paths.insert({piece.triangle, piece.split_path});
        for (int k = 0; k < 3; ++k) {
            const PinholePoint &a = p[k].position, &b = p[(k + 1) % 3].position;
            const double dx = pass.camera.column_of(a.x / a.w) - pass.camera.column_of(b.x / b.w);
            const double dy = pass.camera.row_of(a.y / a.w) - pass.camera.row_of(b.y / b.w);
            diced.longest = std::max(diced.longest, std::sqrt(dx * dx + dy * dy));
            const ScreenPoint from = {a.x, a.y, a.depth}, to = {b.x, b.y, b.depth};
            ++diced.edges[from < to ? Edge(from, to) : Edge(to, from)];
        }
    }
    return diced;
}

} // namespace

TEST_CASE("no edge of a micropolygon exceeds the shading rate, displaced or not, at any distance") {
    const auto maps = random_heights(0.2f);
    for (const HeightMap* map : {static_cast<const HeightMap*>(nullptr), &maps->front()}) {
        for (const double rate : {4.0, 1.0}) {
            const HostMesh sphere(seamless_sphere(), map);
            const Diced far = dice(sphere, looking({1, 2, 5}, {0, 0, 0}), 60, 50, rate);
            CHECK(far.count > 500 / (rate * rate));
            CHECK(far.split_paths.size() == far.count); // gives the subcase its own name
            CHECK(far.longest <= rate);
            CHECK(far.longest > 0.9 * rate);
            const Diced inside = dice(sphere, looking({0.3f, 0.1f, 0.2f}, {1, 1, 0}), 30, 20, rate);
            CHECK(inside.count > 600 / (rate * rate));
            CHECK(inside.longest <= rate);
        }
    }
}

TEST_CASE("micropolygons of a closed mesh share every edge with one other to the bit, even displaced ones") {
    const auto maps = random_heights(0.3f);
    for (const HeightMap* map : {static_cast<const HeightMap*>(nullptr), &maps->front()}) {
        const HostMesh sphere(seamless_sphere(), map);
        const Diced diced = dice(sphere, looking({1, 2, 4}, {0, 0, 0}), 120, 120, 1.5);
        CHECK(diced.count > 5000);
        CHECK(std::ranges::all_of(diced.edges, [](const auto& edge) { return edge.second == 2; }));
    }
}

TEST_CASE("no light leaks through a closed displaced sphere seen from inside") {
    Scene scene = scene_of(seamless_sphere());
    scene.environment = Environment{};
    scene.environment->scale = {1, 1, 1};
    Queue queue = test::requested_queue();
    RenderSettings settings = reyes_settings(150, 110);
    settings.samples = 4;
    settings.ambient = Rgb{0, 0, 0};
    for (const auto& heights : {std::shared_ptr<const HeightMaps>(), random_heights(0.3f)}) {
        settings.heights = heights;
        for (const Vec3 target : {Vec3{1, 0.2f, 0}, Vec3{0, -1, 0.1f}, Vec3{-1, 1, -1}}) {
            const RenderResult result = test::render(queue, scene, looking({0.1f, 0, 0}, target), settings);
            CHECK(*std::ranges::max_element(result.picture.pixels) == 0);
            CHECK(result.invalid_samples == 0);
        }
    }
}

TEST_CASE("micropolygons have the coverage and depth of rays through the same samples") {
    const Scene scene = test::make_mixed_scene();
    Queue queue = test::requested_queue();
    RenderSettings settings = reyes_settings(500, 500);
    settings.aovs = kAovDepth | kAovIds;
    settings.path.max_depth = 0;
    settings.path.seed = 3;
    const RenderResult reyes = test::render(queue, scene, test::mixed_scene_camera(), settings);
    settings.integrator = IntegratorKind::Path;
    const RenderResult path = test::render(queue, scene, test::mixed_scene_camera(), settings);
    const auto& depths = reyes.layers.front().image.pixels;
    const auto& path_depths = path.layers.front().image.pixels;
    uint32_t others = 0, compared = 0;
    double sum = 0;
    for (std::size_t i = 0; i < 250000; ++i) {
        const PixelIds &a = reyes.ids[i], &b = path.ids[i];
        others += a.instance == b.instance && a.material == b.material ? 0 : 1;
        if (b.instance == kNoHit || a.instance != b.instance || a.primitive != b.primitive) continue;
        ++compared;
        sum += double(std::abs(depths[i] - path_depths[i])) / double(path_depths[i]);
    }
    // Positions are rounded to 1/256 of a pixel, so a sample that near to an outline may be in or out. A blended
    // surface makes the same random decision, with the alpha of the micropolygon's centre.
    CHECK(others < 1000);
    CHECK(compared > 100000);
    CHECK(sum / compared < 1e-5);
}

TEST_CASE("a plane displaced by a ramp is the tilted plane, in depth and normal") {
    Mesh mesh = test::sheet({0, 0, 0}, {1, 0, 0}, {0, 1, 0}); // faces +z
    mesh.normals.assign(4, {0, 0, 2});                        // the normal may have any length
    mesh.uv[0] = {{0.25f, 0}, {0.75f, 0}, {0.75f, 1}, {0.25f, 1}};
    const Scene scene = scene_of(mesh);
    // Between the centres of two texels the height rises from 0 at x = -1 to 1 at x = 1.
    const float scale = 0.8f;
    const HeightMap ramp = {0, {.width = 2, .height = 1, .channels = 1, .pixels = {0, 1}}, scale, 0.25f};
    Queue queue = test::requested_queue();
    RenderSettings settings = reyes_settings(64, 64);
    settings.ambient = Rgb{1, 1, 1};
    settings.heights = std::make_shared<const HeightMaps>(HeightMaps{ramp});
    settings.aovs = kAovDepth | kAovNormal | kAovPosition;
    settings.filter = PixelFilter::Box;
    settings.filter_radius = 0x1p-20f;
    const Camera camera = without_perspective(looking({0, 0, 3}, {0, 0, 0}), 1.9f);
    const RenderResult result = test::render(queue, scene, camera, settings);
    const Image &depth = layer_named(result, "depth"), &normal = layer_named(result, "normal");
    const Vec3 tilted = normalize(Vec3{-scale / 2, 0, 1});
    for (uint32_t y = 0; y < 64; ++y) {
        for (uint32_t x = 0; x < 64; ++x) {
            const float at = 1.9f * ((static_cast<float>(x) + 0.5f) / 64 - 0.5f);
            const float height = scale * ((at + 1) / 2 - 0.25f);
            CHECK(std::abs(*depth.at(x, y) - (3 - height)) < 1e-4f);
            CHECK(std::abs(*layer_named(result, "position").at(x, y) - at) < 1e-4f);
            for (int k = 0; k < 3; ++k) {
                CHECK(std::abs(normal.at(x, y)[k] - component(tilted, k)) < 1e-3f);
            }
        }
    }
}

TEST_CASE("each pixel has its own sample positions within its filter, and a picture is their mean") {
    Scene scene;
    test::add(scene, test::sheet({-1, 0, 0}, {1, 0, 0}, {0, 9, 0}), {{.emission = {1, 1, 1}}, "lamp"});
    Queue queue = test::requested_queue();
    RenderSettings settings = reyes_settings(9, 9);
    settings.ambient = Rgb{0, 0, 0};
    settings.filter = PixelFilter::Box;
    settings.filter_radius = 0.5f;
    const Camera camera = without_perspective(looking({0.2f, 0, 2}, {0.2f, 0, 0}), 9); // covers 0.3 of column 4
    const auto column = [&] {
        std::set<float> values;
        double sum = 0;
        const Image picture = test::render(queue, scene, camera, settings).picture;
        for (uint32_t y = 0; y < 9; ++y) values.insert(*picture.at(4, y)), sum += double(*picture.at(4, y));
        CHECK(*picture.at(3, 4) == 1);
        CHECK(*picture.at(5, 4) == 0);
        return std::pair(values.size(), sum / 9);
    };
    settings.samples = 8;
    settings.path.sampler = SamplerKind::Independent;
    CHECK(column().first > 2); // the positions of pixels differ
    settings.samples = 256;
    settings.path.sampler = SamplerKind::Sobol;
    CHECK(column().second == doctest::Approx(0.3).epsilon(0.01));
}

TEST_CASE("micropolygons are lit as raster lights pixels, each with one colour") {
    Scene scene = test::make_furnace_scene(0.7f); // a smooth sphere
    scene.environment.reset();
    scene.materials.front().kind = MaterialKind::MetallicRoughness;
    scene.materials.front().roughness = 0.4f;
    scene.lights.push_back(test::point_light({3, 4, 5}, {90, 80, 70}));
    Queue queue = test::requested_queue();
    RenderSettings settings = reyes_settings(60, 60);
    settings.filter = PixelFilter::Box;
    settings.filter_radius = 0x1p-20f;
    settings.shading_rate = 0.25f;
    const Camera camera = looking({1, 1, 4}, {0, 0, 0});
    const Image reyes = test::render(queue, scene, camera, settings).picture;
    settings.shading_rate = 16;
    const Image coarse = test::render(queue, scene, camera, settings).picture;
    settings.integrator = IntegratorKind::Raster;
    const Image raster = test::render(queue, scene, camera, settings).picture;
    uint32_t alike = 0, lit = 0;
    for (std::size_t i = 0; i < raster.pixels.size(); ++i) {
        if (!(raster.pixels[i] > 0.05f)) continue;
        ++lit;
        alike += std::abs(raster.pixels[i] - reyes.pixels[i]) <= 0.03f * raster.pixels[i] ? 1 : 0;
    }
    CHECK(lit > 1000);
    CHECK(alike >= lit - lit / 50); // except at outlines, and where light varies within a micropolygon
    const std::set<float> fine_colors(reyes.pixels.begin(), reyes.pixels.end());
    const std::set<float> coarse_colors(coarse.pixels.begin(), coarse.pixels.end());
    CHECK(fine_colors.size() > 2 * coarse_colors.size());
}

TEST_CASE("pictures of micropolygons do not depend on threads or passes, and layers describe the first surface") {
    const Scene scene = test::make_mixed_scene(); // cut-outs, blended sheets, hidden backs, instances
    RenderSettings settings = reyes_settings(67, 45);
    settings.samples = 3;
    settings.aovs = kAovAlbedo | kAovNormal | kAovIds | kAovPosition;
    for (const auto& heights :
         {std::shared_ptr<const HeightMaps>(),
          random_heights(0.05f, static_cast<uint32_t>(scene.materials.size()) - 1)}) { // the last picture has no layers
        settings.heights = heights;
        settings.pass_samples = 0;
        Queue queue = Queue::make_cpu();
        const RenderResult one = test::render(queue, scene, test::mixed_scene_camera(), settings);
        CHECK(one.invalid_samples == 0);
        CHECK(test::mean_of(one.picture) > 0);
        for (const int threads : {1, 5}) {
            Queue few = Queue::make_cpu(Threads(threads));
            settings.pass_samples = threads == 1 ? 2 : 1;
            CHECK(test::render_hash(test::render(few, scene, test::mixed_scene_camera(), settings)) ==
                  test::render_hash(one));
        }
        if (!test::cuda_requested()) continue;
        Queue gpu = test::make_cuda_queue();
        CHECK(test::render_hash(test::render(gpu, scene, test::mixed_scene_camera(), settings)) ==
              test::render_hash(one));
    }
}

TEST_CASE("the first pass has few samples, and later ones have as many as fit") {
    Queue queue = test::requested_queue();
    Messages messages;
    const Scene scene = test::make_mixed_scene();
    const PreparedScene prepared = prepare_scene(scene, {}, messages);
    const RenderSettings settings = reyes_settings(24, 16);
    Session session(queue, prepared, test::mixed_scene_camera(), settings);
    std::vector<uint32_t> reported;
    ProgressSink keep([&](const Progress& now) {
        if (reported.empty() || now.samples_done > reported.back()) reported.push_back(now.samples_done);
        return now.samples_done < 32;
    });
    const uint32_t added = session.render(8388607, keep);
    REQUIRE(reported.size() >= 2);
    CHECK(added == reported.back());
    const std::size_t first = reported.front() == 0 ? 1 : 0; // the pass checked the sink
    CHECK(reported.at(first) == 16);
    CHECK(reported.at(first + 1) >= 32);
}

TEST_CASE("heights that fold surfaces without bound are refused, and no sample is incomplete") {
    Queue queue = test::requested_queue();
    Messages messages;
    const Scene scene = test::make_mixed_scene();
    const PreparedScene prepared = prepare_scene(scene, {}, messages);
    RenderSettings settings = reyes_settings(24, 16);
    settings.heights = random_heights(1000, static_cast<uint32_t>(scene.materials.size()) - 1);
    Session session(queue, prepared, test::mixed_scene_camera(), settings);
    const auto error = test::thrown_error([&] { session.render(3); });
    CHECK(test::is_about(error, ErrorCode::OverLimit, "displacement"));
    CHECK(session.history().samples == 0);
    CHECK(test::mean_of(session.picture()) == 0);
}

TEST_CASE("memory of reyes equals its prediction, even for millions of micropolygons") {
    const Scene scene = scene_of(test::sheet({0, 0, 0}, {5, 0, 0}, {0, 5, 0}));
    const Camera camera = looking({0, 0, 1}, {0, 0, 0});
    Queue queue = test::requested_queue();
    RenderSettings settings = reyes_settings(240, 180);
    settings.ambient = Rgb{1, 1, 1};
    settings.shading_rate = 0.25f;
    settings.samples = 2;
    Messages messages;
    const PreparedScene prepared = prepare_scene(scene, {}, messages);
    Session session(queue, prepared, camera, settings);
    session.render(2);
    const std::size_t predicted = predicted_bytes(prepared, settings, queue.is_cuda());
    CHECK(queue.allocated_bytes() >= predicted);
    CHECK(queue.allocated_bytes() <= predicted + 4096); // the filter's table, the scene's view
    const Image picture = session.result().picture;
    CHECK(std::ranges::all_of(picture.pixels, [](float x) { return std::abs(x - 0.5f) < 1e-6f; }));
}

TEST_CASE("reyes refuses a lens and a scene that it would render black") {
    Scene scene = test::make_furnace_scene(0.5f);
    Camera camera;
    camera.aperture_radius = 0.1f;
    Queue queue = test::requested_queue();
    const RenderSettings settings = reyes_settings(40, 30);
    const auto error = test::thrown_error([&] { test::render(queue, scene, camera, settings); });
    CHECK(test::is_about(error, ErrorCode::BadInput, "integrator", "reyes"));
    scene.environment.reset();
    REQUIRE(why_dark(settings, scene));
    CHECK(why_dark(settings, scene)->value == "reyes");
}
