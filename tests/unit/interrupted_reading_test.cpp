// A sink can end the reading of a file and the build of a tree at any of its checks.

#include <doctest/doctest.h>

#include <algorithm>
#include <atomic>
#include <functional>

#include "accel/builders/builders.h"
#include "accel/builders/bvh_cache.h"
#include "accel/bvh/compressed_bvh.h"
#include "accel/bvh/wide_bvh.h"
#include "accel/kd_tree/point_kd_tree.h"
#include "accel/octree/point_octree.h"
#include "base/parallel_for.h"
#include "base/sort_until.h"
#include "formats/gltf/read_gltf.h"
#include "formats/obj/read_obj.h"
#include "formats/ply/read_ply.h"
#include "formats/read_scene.h"
#include "image/write_png.h"
#include "integrators/photon_map/photon_map_settings.h"
#include "render/prepare_scene.h"
#include "tests/support/gltf_builder.h"
#include "tests/support/meshes.h"
#include "tests/support/options.h"
#include "tests/support/render_scenes.h"
#include "tests/support/stress_points.h"
#include "tests/support/thrown_error.h"
#include "tests/support/write_text.h"
#include "tracer/scene_structures.h"

namespace fs = std::filesystem;
using namespace pertev;

namespace {

class StopsAt final : public Sink {
public:
    explicit StopsAt(int64_t check) : left_(check) {}
    bool should_stop() override { return left_.fetch_sub(1) <= 0; }
    int64_t left() const { return left_; }

private:
    std::atomic<int64_t> left_;
};

/// Tests that `work` checks its sink at least `least_checks` times and ends at the first, a middle and the last check.
/// A run may have a check less than another, even on one thread, so the last of another run may be out of reach.
template <class Work>
void check_stops(int64_t least_checks, const Work& work) {
    constexpr int64_t kNever = 1 << 30;
    StopsAt never(kNever);
    work(never);
    const int64_t checks = kNever - never.left();
    CHECK(checks >= least_checks);
    const auto error_at = [&](int64_t check) {
        StopsAt sink(check);
        return test::thrown_error([&] { work(sink); });
    };
    for (const int64_t check : {int64_t(0), checks / 2, checks - 1}) {
        std::optional<Error> error = error_at(check);
        if (!error && check == checks - 1) error = error_at(check - 1);
        REQUIRE(error);
        CHECK(error->code() == ErrorCode::Interrupted);
    }
}

SceneTriangles triangles_of_torus(int segments, int sides) {
    SceneTriangles triangles;
    triangles.baked = test::triangles_of(test::make_torus(segments, sides));
    return triangles;
}

constexpr int kTriangles = 70'000;

std::string repeated(int count, const std::string& line) {
    std::string text;
    for (int i = 0; i < count; ++i) text += line;
    return text;
}

fs::path write_obj(const fs::path& folder) {
    const std::string head = "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nusemtl m\n";
    return test::write_text(folder / "a.obj", head + repeated(kTriangles, "f 1/1 2/1 3/1\n"));
}

} // namespace

TEST_CASE("an OBJ file's pieces, faces, vertices and pictures are read until the sink ends it") {
    const fs::path folder = test::scratch_folder(), path = write_obj(folder);
    test::write_text(folder / "a.mtl", "newmtl m\nmap_Kd a.png\n");
    write_png(folder / "a.png", Rgba8Image{.width = 1, .height = 1, .pixels = {255, 0, 0, 255}}, true);
    const int64_t pieces = 2, faces = kTriangles >> 16, corners = 3 * kTriangles >> 16, pictures = 1;
    check_stops(pieces + faces + corners + pictures, [&](Sink& sink) {
        const UseThreads one(1);
        read_obj(path, FileAccess(path, {}), {}, sink);
    });
    StopsAt sink(3); // stops while another thread reads the materials
    const std::optional<Error> error = test::thrown_error([&] { read_obj(path, FileAccess(path, {}), {}, sink); });
    CHECK((error && error->code() == ErrorCode::Interrupted));
}

TEST_CASE("a PLY file's vertices and faces are read until the sink ends it") {
    const std::string head = "ply\nformat ascii 1.0\nelement vertex 70000\nproperty float x\nproperty float y\n"
                             "property float z\nelement face 140000\nproperty list uchar int vertex_indices\n"
                             "end_header\n";
    const fs::path path = test::write_text(test::scratch_folder() / "a.ply",
                                           head + repeated(70'000, "0 0 0\n") + repeated(140'000, "3 0 1 2\n"));
    check_stops(2 + 3, [&](Sink& sink) { read_ply(path, FileAccess(path, {}), {}, sink); });
}

TEST_CASE("a glTF file's nodes, primitives and animations are read until the sink ends it") {
    test::GltfBuilder builder;
    const int positions = builder.add("VEC3", std::vector<float>{0, 0, 0, 1, 0, 0, 0, 1, 0});
    const std::string primitive = "{\"attributes\":{\"POSITION\":" + std::to_string(positions) + "}}";
    const fs::path path = test::write_text(
        test::scratch_folder() / "a.gltf",
        builder.json("\"meshes\":[{\"primitives\":[" + primitive + "," + primitive +
                     "]}],\"nodes\":[{\"mesh\":0},{\"mesh\":0}],\"animations\":[{\"channels\":[],\"samplers\":[]}]"));
    check_stops(2 + 2 + 1, [&](Sink& sink) { read_gltf(path, FileAccess(path, {}), {}, sink); });
}

TEST_CASE("every builder ends at a check of its sink") {
    const std::vector<BvhTriangle> triangles = test::triangles_of(test::make_torus(110, 80));
    for (const BvhBuilder builder : kValuesOf<BvhBuilder>) {
        CAPTURE(name_of(builder));
        check_stops(1, [&](Sink& sink) { build_bvh(builder, triangles, {.sink = &sink}); });
    }
}

TEST_CASE("pieces are sorted and merged until the sink ends it, and the result is that of one sort") {
    constexpr int64_t kPiece = 1 << 16;
    for (const int64_t count : {int64_t(0), int64_t(1), kPiece - 1, kPiece, kPiece + 1, 3 * kPiece, 5 * kPiece + 7}) {
        CAPTURE(count);
        std::vector<uint64_t> values;
        for (int64_t i = 0; i < count; ++i) values.push_back(static_cast<uint64_t>(i) * 0x9e3779b97f4a7c15u);
        std::vector<uint64_t> wanted = values;
        std::ranges::sort(wanted, std::greater<>());
        sort_until(std::span(values), nobody(), std::greater<>());
        CHECK(values == wanted);
    }
    std::vector<int> ascending(5 * kPiece); // five pieces, then merges to three runs, to two, and to one
    for (std::size_t i = 0; i < ascending.size(); ++i) ascending[i] = static_cast<int>(i);
    check_stops(5 + 3 + 2 + 1, [&](Sink& sink) { sort_until(std::span(ascending), sink); });
}

TEST_CASE("builders that sort all triangles, and those of a curve, check the sink in each of their loops") {
    const std::vector<BvhTriangle> triangles = test::triangles_of(test::make_torus(250, 280)); // 140,000
    const int64_t checks = 3, sort = 3 + 2 + 1; // a loop over triangles; pieces and merges
    const auto build = [&](BvhBuilder builder) {
        return [&triangles, builder](Sink& sink) { build_bvh(builder, triangles, {.sink = &sink}); };
    };
    check_stops(3 * sort + 2 * 8, build(BvhBuilder::Sweep)); // eight ranges are so long that axes are parallel
    check_stops(sort + checks, build(BvhBuilder::Ploc));
    check_stops(checks + sort + 2 * checks + 2 * checks - 1,
                build(BvhBuilder::Hploc)); // the last checks are those of the nodes
}

TEST_CASE("every structure of the laboratory is built until the sink ends it") {
    const SceneTriangles triangles = triangles_of_torus(250, 140); // 70,000
    const BinaryTrees trees = build_binary_trees(triangles, BvhBuilder::Median);
    const auto convert = [&](TreeLayout layout, StructureKind kind = StructureKind::Median) {
        return [&, layout, kind](Sink& sink) { BuiltStructure(Tlas(), kind, layout, trees, nullptr, sink); };
    };
    const auto build = [&](StructureKind kind) {
        return [&, kind](Sink& sink) { BuiltStructure(Tlas(), kind, triangles, nullptr, sink); };
    };
    const int64_t checks = 2, sort = 2 + 1 + 1;
    const auto nodes = static_cast<int64_t>(trees.baked().nodes.size());
    check_stops((nodes >> 16) + 1, convert(TreeLayout::Linked));
    check_stops((3 * nodes >> 16) + 1, convert(TreeLayout::Skip)); // inner nodes twice, and leaves
    check_stops(checks, convert(TreeLayout::Woop));
    check_stops(1 + sort + checks + 5, convert(TreeLayout::Compressed, StructureKind::Hploc)); // 5: levels of nodes
    // A kd-tree's root has 70,000 triangles, and at least 15 nodes have more than 4096. An octree's have over 8192.
    check_stops(checks + 15 + checks - 1, build(StructureKind::KdMedian));
    check_stops(110, build(StructureKind::KdSah)); // There are 123, of which 36 are of the axes of large cells.
    check_stops(checks + 3 + checks - 1, build(StructureKind::Octree));
}

TEST_CASE("the trees over photons end at a check of the sink") {
    test::Random random(8);
    std::vector<Vec3> points;
    std::vector<Sphere> spheres;
    for (int i = 0; i < 140'000; ++i) {
        points.push_back(random.point(-1, 1));
        spheres.push_back({points.back(), 0});
    }
    check_stops(31, [&](Sink& sink) { build_point_kd_tree(points, sink); }); // nodes with at least 4096 points
    check_stops(1 + 8, [&](Sink& sink) { build_point_octree(spheres, sink); });
}

TEST_CASE("a photon map's first pass is abandoned wherever the sink stops it, also while it builds trees") {
    Queue queue = Queue::make_cpu(Threads(1));
    const Scene scene = test::make_mixed_scene();
    const PreparedScene prepared = prepare_scene(scene, {}, nobody());
    for (const PhotonSearch search : {PhotonSearch::KdTree, PhotonSearch::Octree}) {
        RenderSettings settings;
        settings.width = settings.height = 8;
        settings.integrator = IntegratorKind::PhotonMap;
        settings.photon_map.edit().photons = 40'000;
        settings.photon_map.edit().search = search;
        constexpr int64_t kNever = 1 << 30;
        StopsAt never(kNever);
        Session whole(queue, prepared, test::mixed_scene_camera(), settings);
        REQUIRE(whole.render(1, never) == 1);
        const int64_t checks = kNever - never.left();
        Session session(queue, prepared, test::mixed_scene_camera(), settings);
        for (int64_t part = 0; part < 12; ++part) {
            StopsAt sink(checks * part / 12);
            CHECK(session.render(1, sink) == 0);
        }
        REQUIRE(session.render(1) == 1);
        CHECK(test::render_hash(session.result()) == test::render_hash(whole.result()));
    }
}

TEST_CASE("an update of the scene ignores a structure whose build was ended") {
    const BinaryTrees trees = build_binary_trees(triangles_of_torus(20, 10), BvhBuilder::Binned);
    SceneStructures structures(BvhBuilder::Binned, trees, Tlas());
    const Combination octree = {.structure = StructureKind::Octree, .traversal = TraversalKind::Octree};
    StopsAt at_once(0);
    REQUIRE(test::thrown_error([&] { structures.get(octree, at_once); }));
    const std::shared_ptr<SceneStructures> after = structures.updated(trees, Tlas(), {PartChange::None}, {});
    CHECK(after->get(octree)->figures().triangles >= 400);
}

TEST_CASE("a tree is stored, read, and made wide until the sink ends it, and an ended store leaves no file") {
    const std::vector<BvhTriangle> triangles = test::triangles_of(test::make_torus(300, 220));
    const auto parts = static_cast<int64_t>(triangles.size() >> 16);
    const Bvh bvh = build_bvh(triangles);
    check_stops(4 * parts, [&](Sink& sink) { make_wide_bvh<8>(bvh, kSimdCollapse, sink); });
    check_stops(5 * parts, [&](Sink& sink) { make_compressed_bvh(bvh, kCompressedCollapse, sink); });

    const fs::path folder = test::scratch_folder() / "cache";
    const Hash128 key = bvh_cache_key(triangles, {});
    const BuiltTree tree = build_triangle_tree(triangles, {});
    const auto store = [&](Sink& sink) { store_cached_bvh(key, folder, tree, triangles.size(), sink); };
    check_stops(parts + 1, store);
    fs::remove_all(folder);
    StopsAt at_writing(parts + 1);
    REQUIRE(test::thrown_error([&] { store(at_writing); }));
    CHECK(fs::is_empty(folder));
    store(nobody());
    check_stops(2 * parts, [&](Sink& sink) { load_cached_bvh(key, folder, triangles, sink); });
}

TEST_CASE("the validation and the trees of a scene end at a check of the sink") {
    const UseThreads one(1); // with more, the number of checks differs between runs
    const fs::path path = write_obj(test::scratch_folder());
    check_stops(8, [&](Sink& sink) { read_scene(path, {}, sink); });
    const Scene scene = read_scene(path, {}, nobody());
    PrepareOptions options;
    options.tracers = default_tracers(false);
    check_stops(4, [&](Sink& sink) { prepare_scene(scene, options, sink); });
}
