// Hierarchical radiosity: its links are compared with rows of form factors and with closed forms, and are few.

#include <doctest/doctest.h>

#include <cmath>
#include <set>
#include <string>

#include <fmt/format.h>

#include "base/parallel_for.h"
#include "radiosity/cluster_tree.h"
#include "radiosity/hierarchical.h"
#include "radiosity/polygon_form_factor.h"
#include "tests/support/radiosity_scenes.h"
#include "tests/support/random.h"
#include "tests/support/thrown_error.h"
#include "trace/intersect/intersect_triangle.h"

using namespace pertev;

namespace {

Scene room_with_boxes() {
    Scene scene = test::closed_box(test::white(0.6f));
    test::add(scene, test::sheet({0, 0.98f, 0}, {0.4f, 0, 0}, {0, 0, 0.4f}),
              test::emitter_material(0, 5)); // faces down
    test::add(scene, test::sheet({-0.3f, -0.2f, 0}, {0.4f, 0, 0}, {0, 0, 0.4f}), test::white(0.4f));
    return scene;
}

SolvedRadiosity solved_by(const Scene& scene, RadiositySolver solver, float patch_size, float link_error = 0.05f) {
    Messages messages;
    const PreparedScene prepared = prepare_scene(scene, {}, messages);
    RadiositySettings settings;
    settings.solver = solver;
    settings.patch_size = patch_size;
    settings.link_error = link_error;
    settings.subdivisions = 0;
    return solve_radiosity(prepared, settings);
}

/// Subdivides each triangle into four, this number of times.
void divide_triangles(Mesh& mesh, int times) {
    for (; times > 0; --times) {
        std::vector<uint32_t> indices;
        for (std::size_t t = 0; t < mesh.indices.size(); t += 3) {
            uint32_t middle[3];
            for (std::size_t k = 0; k < 3; ++k) {
                middle[k] = static_cast<uint32_t>(mesh.positions.size());
                const Vec3 a = mesh.positions[mesh.indices[t + k]], b = mesh.positions[mesh.indices[t + (k + 1) % 3]];
                mesh.positions.push_back(0.5f * (a + b));
            }
            for (std::size_t k = 0; k < 3; ++k) {
                for (const uint32_t i : {mesh.indices[t + k], middle[k], middle[(k + 2) % 3]}) indices.push_back(i);
            }
            indices.insert(indices.end(), middle, middle + 3);
        }
        mesh.indices = indices;
    }
}

/// Returns the root mean squared difference of the displayed light over the scene, relative to the mean.
double difference_of(const RadiositySolution& a, const RadiositySolution& b) {
    double squares = 0, sum = 0, count = 0;
    test::Random random(3);
    for (uint32_t face = 0; face < a.roots.size(); ++face) {
        for (int i = 0; i < 64; ++i) {
            const Vec2 at = sample_uniform_triangle(random.pair());
            const auto x = static_cast<double>(a.view().irradiance(face, at.x, at.y).g),
                       y = static_cast<double>(b.view().irradiance(face, at.x, at.y).g);
            squares += (x - y) * (x - y), sum += y, count += 1;
        }
    }
    return std::sqrt(squares / count) / (sum / count);
}

} // namespace

TEST_CASE("links converge to the solution of form factor rows as their error bound shrinks") {
    const Scene scene = room_with_boxes();
    const SolvedRadiosity rows = solved_by(scene, RadiositySolver::GaussSeidel, 0.4f);
    double before = 1e9;
    uint64_t links_before = 0;
    for (const float link_error : {0.8f, 0.2f, 0.05f}) {
        const SolvedRadiosity links = solved_by(scene, RadiositySolver::Hierarchical, 0.4f, link_error);
        const double difference = difference_of(links.solution, rows.solution);
        CAPTURE(link_error);
        CAPTURE(difference);
        CHECK(difference < 1.05 * before); // few links can be accurate by chance
        CHECK(links.stats.factors > links_before);
        CHECK(links.stats.left < 1e-3);
        before = difference;
        links_before = links.stats.factors;
    }
    CHECK(before < 0.04);
    // This is the number of all pairs of patches.
    CHECK(links_before < rows.stats.patches * rows.stats.patches / 10);
}

TEST_CASE("links lose no light to surfaces inside solids") {
    Scene scene = test::closed_box(test::white(0.7f));
    test::add(scene, test::sheet({0, 0.98f, 0}, {0.2f, 0, 0}, {0, 0, 0.2f}), test::emitter_material(0, 20));
    for (int x = 0; x < 4; ++x) {
        for (int z = 0; z < 4; ++z) { // pillars whose sides face both inwards and outwards
            const float r = 0.12f, h = 0.6f;
            const Vec3 c = {-0.675f + 0.45f * static_cast<float>(x), -1 + h, -0.675f + 0.45f * static_cast<float>(z)};
            test::add(scene, test::sheet(c + Vec3{r, 0, 0}, {0, h, 0}, {0, 0, r}), test::white(0.7f));
            test::add(scene, test::sheet(c - Vec3{r, 0, 0}, {0, h, 0}, {0, 0, r}), test::white(0.7f));
            test::add(scene, test::sheet(c + Vec3{0, 0, r}, {r, 0, 0}, {0, h, 0}), test::white(0.7f));
            test::add(scene, test::sheet(c - Vec3{0, 0, r}, {r, 0, 0}, {0, h, 0}), test::white(0.7f));
            test::add(scene, test::sheet(c + Vec3{0, h, 0}, {r, 0, 0}, {0, 0, r}), test::white(0.7f));
        }
    }
    for (Mesh& mesh : scene.meshes) divide_triangles(mesh, 1);
    const RadiositySolution links = solved_by(scene, RadiositySolver::Hierarchical, 1, 0.3f).solution,
                            rows = solved_by(scene, RadiositySolver::GaussSeidel, 1).solution;
    double by_links = 0, by_rows = 0;
    for (uint32_t face = 0; face < rows.roots.size(); ++face) {
        const auto light = static_cast<double>(rows.view().irradiance(face, 0.3f, 0.3f).g);
        if (light < 0.1) continue; // inside
        by_links += static_cast<double>(links.view().irradiance(face, 0.3f, 0.3f).g);
        by_rows += light;
    }
    CHECK(by_links ==
          doctest::Approx(by_rows).epsilon(0.03)); // it is 0.08 if clusters contain both inner and outer faces
}

TEST_CASE("a closed box that emits E and reflects r has radiosity E / (1 - r) with links") {
    const float reflectance = 0.5f;
    const SolvedRadiosity solved =
        solved_by(test::closed_box(test::emitter_material(reflectance, 1)), RadiositySolver::Hierarchical, 0.4f, 0.02f);
    const double known = 3.14159265 / (1 - static_cast<double>(reflectance));
    double sum = 0;
    for (uint32_t triangle = 0; triangle < 12; ++triangle) {
        for (const Vec2 at : {Vec2{0.3f, 0.3f}, Vec2{0.1f, 0.5f}, Vec2{0.7f, 0.2f}}) {
            sum += static_cast<double>(solved.solution.view().irradiance(2 * triangle, at.x, at.y).g) / 36;
        }
    }
    CHECK(sum == doctest::Approx(known).epsilon(0.01));
}

TEST_CASE("links over the limit are refined again with a larger error and give the bytes of that error") {
    const test::PatchedScene patched(room_with_boxes(), kInfinity);
    const auto solve = [&](float link_error, uint64_t max_links) {
        RadiositySettings settings;
        settings.link_error = link_error;
        WorkWatch watch(nobody());
        return solve_hierarchically(patched.solved, patched.tree, 0.4f, settings, watch, max_links);
    };
    const HierarchicalSolution fine = solve(0.05f, kMaxLinks), coarse = solve(0.4f, kMaxLinks);
    REQUIRE(fine.link_error == 0.05f);
    REQUIRE(fine.links > 4 * coarse.links);
    HierarchicalSolution at_once;
    for (const int threads : {1, 3}) {
        const UseThreads use(threads);
        const HierarchicalSolution limited = solve(0.05f, fine.links / 2);
        CHECK(limited.links <= fine.links / 2);
        const float factor = limited.link_error / 0.05f;
        CHECK((factor == 2 || factor == 4 || factor == 8));
        if (threads == 1) at_once = solve(limited.link_error, kMaxLinks);
        CHECK(at_once.link_error == limited.link_error);
        CHECK(at_once.links == limited.links);
        CHECK(at_once.irradiance == limited.irradiance);
        CHECK(at_once.irradiance != fine.irradiance);
    }
    const auto error = test::thrown_error([&] { solve(0.05f, 0); });
    CHECK(test::is_about(error, ErrorCode::OverLimit, "solver", "hierarchical"));
}

TEST_CASE("a solution with an enlarged error warns and records that error") {
    const test::PatchedScene patched(room_with_boxes(), kInfinity);
    RadiositySettings settings;
    settings.solver = RadiositySolver::Hierarchical;
    settings.patch_size = 0.4f, settings.subdivisions = 0;
    settings.link_error = 0.05f;
    std::set<std::string> reported;
    ProgressSink report([&](const Progress& now) { return reported.insert(now.doing), true; });
    const uint64_t most = solve_radiosity(patched.prepared, settings).stats.factors / 2;
    const SolvedRadiosity solved = solve_radiosity(patched.prepared, settings, report, most);
    REQUIRE(solved.stats.link_error >= 0.1f);
    CHECK(solved.solution.made.find(fmt::format(R"("link_error":{},)", solved.stats.link_error)) != std::string::npos);
    CHECK(reported.contains("links, pass 1"));
    CHECK(reported.contains(fmt::format("links, pass 1, again with `link_error={}`", solved.stats.link_error)));
}

TEST_CASE("solutions with a larger error or fewer steps than requested warn") {
    RadiositySettings settings;
    settings.solver = RadiositySolver::Hierarchical;
    const auto remark_of = [&](const SolveStats& stats) {
        Messages messages;
        warn_of_limits(stats, settings, messages);
        return messages.all().empty() ? Remark("") : messages.all().front().remark;
    };
    CHECK(remark_of({.link_error = settings.link_error}).reason.empty());
    const Remark larger = remark_of({.link_error = 0.4f}),
                 limit = remark_of({.steps = 24, .left = 0.5, .reached_limit = true});
    CHECK(larger.setting == "link_error");
    CHECK(larger.value == "0.1");
    CHECK(larger.reason.find("`link_error=0.4`") != std::string::npos);
    CHECK(limit.setting == "tolerance");
    CHECK(limit.reason.find("after 24 steps") != std::string::npos);
}

TEST_CASE("links do not depend on the number of threads") {
    const Scene scene = room_with_boxes();
    const Hash128 reference = solved_by(scene, RadiositySolver::Hierarchical, 0.5f, 0.1f).solution.hash();
    for (const int threads : {1, 5}) {
        const UseThreads use(threads);
        CHECK(solved_by(scene, RadiositySolver::Hierarchical, 0.5f, 0.1f).solution.hash() == reference);
    }
    CHECK(solved_by(scene, RadiositySolver::Hierarchical, 0.5f, 0.2f).solution.hash() != reference);
}

TEST_CASE("light leaving a cluster depends on its direction") {
    test::Random random(9);
    SentLight sent;
    std::vector<Vec3> normals;
    for (int i = 0; i < 200; ++i) {
        Vec3 normal = random.direction();
        normal.z = pertev::abs(normal.z); // the scene is a hill
        normals.push_back(normal);
        sent.add(normal, {0.5f, 1, 0});
    }
    for (int i = 0; i < 50; ++i) {
        const Vec3 direction = random.direction();
        double exact = 0;
        for (const Vec3 normal : normals) exact += static_cast<double>(max(dot(normal, direction), 0.0f));
        CHECK(std::abs(static_cast<double>(sent.towards(direction).g) - exact) < 0.06 * 200);
        CHECK(sent.towards(direction).b == 0);
    }
}

TEST_CASE("clusters contain each face once, within their bounding spheres") {
    test::Random random(4);
    std::vector<uint32_t> faces;
    std::vector<Ball> balls;
    std::vector<Vec3> normals;
    std::vector<int> levels;
    for (uint32_t i = 0; i < 1000; ++i) {
        levels.push_back(static_cast<int>(random.below(5)) - 3);
        faces.push_back(7 * i);
        balls.push_back({random.point(-3, 3), random.within(0.01f, 0.5f)});
        normals.push_back(i % 2 == 0 ? random.direction() : -normals.back()); // adds a back
    }
    const ClusterTree tree = make_clusters(faces, balls, normals, levels);
    CHECK(tree.clusters.size() == 1999);
    std::vector<uint32_t> found = tree.faces;
    std::ranges::sort(found);
    CHECK(found == faces);
    for (const Cluster& cluster : tree.clusters) {
        for (uint32_t i = cluster.first; i < cluster.first + cluster.count; ++i) {
            const Ball& ball = balls[tree.faces[i] / 7];
            if (cluster.count < 10) { // the faces have about the same direction
                CHECK(dot(normals[tree.faces[i] / 7], normals[tree.faces[cluster.first] / 7]) > -0.5f);
                CHECK(levels[tree.faces[i] / 7] == levels[tree.faces[cluster.first] / 7]);
            }
            CHECK(length(ball.centre - cluster.ball.centre) + ball.radius <= 1.0001f * cluster.ball.radius);
        }
    }
}

TEST_CASE("clusters of triangles are linked to each other, so that links grow linearly with triangles") {
    double links_a_triangle[2];
    for (int fine = 0; fine < 2; ++fine) {
        Scene scene = test::closed_box(test::white(0.6f));
        test::add(scene, test::sheet({0, 0.98f, 0}, {0.4f, 0, 0}, {0, 0, 0.4f}), test::emitter_material(0, 5));
        for (std::size_t i = 0; i < 6; ++i) divide_triangles(scene.meshes[i], fine == 0 ? 2 : 3);
        const SolvedRadiosity solved = solved_by(scene, RadiositySolver::Hierarchical, 1, 0.1f);
        const double triangles = fine == 0 ? 12 * 16 : 12 * 64;
        links_a_triangle[fine] = static_cast<double>(solved.stats.factors) / triangles;
        CAPTURE(links_a_triangle[fine]);
        CHECK(links_a_triangle[fine] < 100);
        const double difference =
            difference_of(solved.solution, solved_by(scene, RadiositySolver::GaussSeidel, 1).solution);
        CAPTURE(difference);
        CHECK(difference < 0.1);
    }
    CHECK(links_a_triangle[1] < 1.3 * links_a_triangle[0]);
}

TEST_CASE("a triangle's form factor at a point is the share of cosine-weighted rays that hit it") {
    test::Random random(7);
    for (int i = 0; i < 40; ++i) {
        const Vec3 a = random.point(-2, 2), b = random.point(-2, 2), c = random.point(-2, 2);
        const Vec3 corner[] = {a, b, c};
        const Vec3 normal = random.direction();
        const Frame frame = make_frame(normal);
        constexpr int kRays = 200; // squared
        int met = 0;
        for (int k = 0; k < kRays * kRays; ++k) {
            const Vec3 local = sample_cosine_hemisphere(
                {(static_cast<float>(k % kRays) + 0.5f) / kRays, (static_cast<float>(k / kRays) + 0.5f) / kRays});
            TriangleHit hit;
            const RayShear ray = make_ray_shear(frame.to_world(local));
            met += intersect_triangle({0, 0, 0}, ray, 0, kInfinity, a, b, c, hit) ? 1 : 0;
        }
        const double known = static_cast<double>(met) / (kRays * kRays);
        CHECK(std::abs(static_cast<double>(triangle_form_factor(corner, normal)) - known) < 3e-3);
    }
}
