// The scenes of rays on the record: as many triangles as stated, where they belong, the same for any number of threads.

#include "lab/record_scenes.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <map>

#include "base/parallel_for.h"
#include "lab/make_bunny_box.h"
#include "lab/make_forest.h"
#include "scene/validate/validate.h"
#include "tests/support/meshes.h"
#include "tests/support/options.h"
#include "tests/support/thrown_error.h"

using namespace pertev;
using namespace pertev::test;

namespace {

Mesh ball(int subdivisions) {
    const TriangleMesh from = make_sphere(subdivisions, {5, -3, 2}, 0.1f);
    Mesh mesh;
    mesh.positions = from.positions;
    mesh.indices = from.indices;
    return mesh;
}

/// Returns how often each edge is used; `first` triangles are looked at.
std::map<std::pair<uint32_t, uint32_t>, int> edges_of(const Mesh& mesh, uint32_t first) {
    std::map<std::pair<uint32_t, uint32_t>, int> edges;
    for (uint32_t i = 0; i < 3 * first; ++i) {
        const uint32_t a = mesh.indices[i], b = mesh.indices[i % 3 == 2 ? i - 2 : i + 1];
        ++edges[{std::min(a, b), std::max(a, b)}];
    }
    return edges;
}

} // namespace

TEST_CASE("a mesh in the open box is sixteen times finer, still closed, and stands on the floor") {
    const Mesh coarse = ball(2);
    const Mesh mesh = make_bunny_box(coarse);
    const uint32_t fine = 16 * coarse.triangle_count();
    CHECK(mesh.triangle_count() == fine + 4 * 32 * 32 * 2);
    for (const auto& [edge, uses] : edges_of(mesh, fine)) CHECK(uses == 2);

    Mesh alone = mesh;
    alone.indices.resize(3 * std::size_t{fine});
    const Bounds3 box = bounds_of(alone), room = bounds_of(mesh);
    CHECK(box.lo.y == 0);
    CHECK(box.hi.y == doctest::Approx(2).epsilon(1e-5));
    CHECK(box.centre().x == doctest::Approx(0).epsilon(1e-5));
    CHECK(box.centre().z == doctest::Approx(0).epsilon(1e-5));
    CHECK(room.lo == Vec3{-3, 0, -3});
    CHECK(room.hi == Vec3{3, 4, 3});
    // The bulge keeps a ball a ball: no vertex is further off than the roughness of two subdivisions allows.
    float least = 9, most = 0;
    for (const uint32_t index : alone.indices) {
        const float distance = length(mesh.positions[index] - Vec3{0, 1, 0});
        least = std::min(least, distance), most = std::max(most, distance);
    }
    CHECK(least > 0.95f);
    CHECK(most < 1.05f);
    CHECK(most - least > 0.005f); // it is rough
}

TEST_CASE("the forest has the same triangles within its bounds for any number of threads") {
    CHECK(ForestSettings{}.triangle_count() == 8223200);
    const ForestSettings small = {.ground_quads = 40, .trees = 30, .leaves = 200};
    const Mesh mesh = make_forest(small);
    CHECK(mesh.triangle_count() == small.triangle_count());
    const Bounds3 box = bounds_of(mesh);
    CHECK(box.lo.x >= -104);
    CHECK(box.hi.z <= 104);
    CHECK(box.lo.y >= -0.2f);
    CHECK(box.hi.y <= 12 + 11 + 4.8f + 0.2f);
    uint32_t degenerate = 0;
    for (std::size_t i = 0; i < mesh.indices.size(); i += 3) {
        const Vec3 a = mesh.positions[mesh.indices[i]], b = mesh.positions[mesh.indices[i + 1]];
        degenerate += length(cross(b - a, mesh.positions[mesh.indices[i + 2]] - a)) > 0 ? 0 : 1;
    }
    CHECK(degenerate == 0);

    const int before = thread_count();
    for (const int threads : {1, 3}) {
        set_thread_count(threads);
        const Mesh again = make_forest(small);
        CHECK(again.positions == mesh.positions);
        CHECK(again.indices == mesh.indices);
    }
    set_thread_count(before);
}

TEST_CASE("scenes of the record have the stated number of triangles") {
    const auto sponza = test_scene("crytek-sponza/sponza.obj"), bunny = test_scene("stanford/bunny.obj");
    for (const RecordScene& record : the_record().scenes) {
        const std::string_view name = record.name;
        if ((name == "sponza" && !sponza) || (name == "bunny" && !bunny)) continue;
        if (name == "forest" && effort(0, 1) == 0) continue;
        const auto folder =
            name == "forest" ? std::filesystem::path() : (sponza ? sponza : bunny)->parent_path().parent_path();
        Messages messages;
        Scene scene = make_record_scene(record, folder, messages);
        CAPTURE(record.name);
        CHECK(scene.meshes[0].triangle_count() == record.triangles);
        validate(scene, record.name, messages);
        CHECK(scene.meshes[0].triangle_count() == record.triangles);
    }
}

TEST_CASE("a scene whose file is missing is refused with the file's name") {
    Messages messages;
    for (const char* name : {"sponza", "bunny"}) {
        const RecordScene& record = *find_named(the_record().scenes, name);
        for (const std::filesystem::path& folder : {std::filesystem::path(), scratch_folder()}) {
            CHECK(bad_input_message([&] { make_record_scene(record, folder, messages); }).find(record.file) !=
                  std::string::npos);
        }
    }
    CHECK(find_named(the_record().scenes, "sponz") == nullptr);
}
