// A sink can end the reading of a file and the build of a tree at any of its checks.

#include <doctest/doctest.h>

#include <atomic>

#include "accel/builders/builders.h"
#include "accel/builders/bvh_cache.h"
#include "accel/bvh/compressed_bvh.h"
#include "accel/bvh/wide_bvh.h"
#include "base/parallel_for.h"
#include "formats/gltf/read_gltf.h"
#include "formats/obj/read_obj.h"
#include "formats/ply/read_ply.h"
#include "formats/read_scene.h"
#include "image/write_png.h"
#include "render/prepare_scene.h"
#include "tests/support/gltf_builder.h"
#include "tests/support/meshes.h"
#include "tests/support/options.h"
#include "tests/support/thrown_error.h"
#include "tests/support/write_text.h"

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

/// Checks that `work` checks its sink at least so often, and that it ends at the first, a middle and the last
/// check.
template <class Work>
void check_stops(int64_t least_checks, const Work& work) {
    constexpr int64_t kNever = 1 << 30;
    StopsAt never(kNever);
    work(never);
    const int64_t checks = kNever - never.left();
    CHECK(checks >= least_checks);
    for (const int64_t check : {int64_t(0), checks / 2, checks - 1}) {
        StopsAt sink(check);
        const std::optional<Error> error = test::thrown_error([&] { work(sink); });
        REQUIRE(error);
        CHECK(error->code() == ErrorCode::Interrupted);
    }
}

constexpr int kTriangles = 200'000;

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
    write_png(folder / "a.png", {.width = 1, .height = 1, .pixels = {255, 0, 0, 255}}, true);
    const int64_t pieces = 2, faces = kTriangles >> 16, corners = 3 * kTriangles >> 16, pictures = 1;
    check_stops(pieces + faces + corners + pictures, [&](Sink& sink) {
        const UseThreads one(1);
        read_obj(path, FileAccess(path, {}), {}, sink);
    });
    StopsAt sink(3); // while another thread reads the materials
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

TEST_CASE("a tree is stored, read, and made wide until the sink ends it, and an ended store leaves no file") {
    const std::vector<BvhTriangle> triangles = test::triangles_of(test::make_torus(500, 400));
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
