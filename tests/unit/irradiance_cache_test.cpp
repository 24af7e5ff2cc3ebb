// Parts, records and pictures of irradiance caching against closed forms.

#include <doctest/doctest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <ctime>
#include <thread>
#include <utility>
#include <vector>

#include "base/parallel_for.h"
#include "device_scene/scene_on_device.h"
#include "integrators/irradiance_cache/hemisphere_stages.h"
#include "integrators/irradiance_cache/irradiance_cache_integrator.h"
#include "integrators/irradiance_cache/overture_grid.h"
#include "integrators/irradiance_cache/overture_progress.h"
#include "integrators/irradiance_cache/record_store.h"
#include "render/film.h"
#include "render/filter_table.h"
#include "session/check_integrator.h"
#include "tests/support/meshes.h"
#include "tests/support/options.h"
#include "tests/support/random.h"
#include "tests/support/room_with_ball.h"

using namespace pertev;

namespace {

constexpr HemisphereGrid kFine = {64, 200};

/// Returns the sum over cells; `cell_of` returns the cell of a ray's world direction.
template <class CellOf>
HemisphereSum sum_over(const HemisphereGrid& grid, const Frame& frame, const CellOf& cell_of) {
    return sum_hemisphere(grid, frame, [&](uint32_t cell) {
        return cell_of(normalize(frame.to_world(direction_in_cell(grid, cell, {0.5f, 0.5f}))));
    });
}

void check_near(Vec3 a, Vec3 b, float within) {
    CAPTURE(a.x);
    CAPTURE(a.y);
    CAPTURE(a.z);
    CAPTURE(b.x);
    CAPTURE(b.y);
    CAPTURE(b.z);
    CHECK(length(a - b) <= within);
}

std::vector<float> clamped_radii(std::span<const Sphere> records) {
    Queue host = Queue::make_cpu();
    SpacingMemory memory;
    memory.grow(host, records.size());
    std::vector<float> clamped(records.size());
    clamp_by_neighbours(records, memory, clamped);
    return clamped;
}

} // namespace

TEST_CASE("a hemisphere's cells have equal cosine-weighted sizes and at most the requested rays") {
    for (const uint32_t rays : {16u, 100u, 768u, 65536u}) {
        const HemisphereGrid grid = make_hemisphere_grid(rays);
        CHECK(grid.cells() <= rays);
        CHECK(grid.cells() > rays * 3 / 4);
        Vec3 mean = {0, 0, 0};
        for (uint32_t cell = 0; cell < grid.cells(); ++cell) {
            const Vec3 w = direction_in_cell(grid, cell, {0.5f, 0.5f});
            CHECK(w.z > 0);
            CHECK(length(w) == doctest::Approx(1).epsilon(1e-5));
            mean += (1.0f / static_cast<float>(grid.cells())) * w;
        }
        check_near(mean, {0, 0, 2.0f / 3}, 0.02f); // the mean of the cosine is 2/3
    }
}

TEST_CASE("the rotational gradient under a known sky matches the irradiance of a rotated surface") {
    // Under radiance 1 + b w irradiance is pi (1 + 2/3 b n): its derivative by n is 2/3 b, across n.
    const Vec3 b = {0.3f, -0.4f, 0.2f};
    for (const Vec3 normal : {Vec3{0, 0, 1}, normalize(Vec3{1, -2, 0.5f}), Vec3{0, -1, 0}}) {
        const HemisphereSum sum = sum_over(kFine, make_frame(normal), [&](Vec3 w) {
            return HemisphereCell{{1.0f + dot(b, w), 2.0f, 0.0f}, kInfinity};
        });
        CHECK(sum.light.r == doctest::Approx(1 + 2.0 / 3 * static_cast<double>(dot(b, normal))).epsilon(1e-3));
        CHECK(sum.light.g == doctest::Approx(2));
        check_near(sum.by_turn[0], (2.0f / 3) * (b - dot(b, normal) * normal), 2e-3f);
        check_near(sum.by_turn[1], {0, 0, 0}, 1e-4f);
        for (const Vec3 move : sum.by_move) check_near(move, {0, 0, 0}, 1e-6f); // all surfaces are far away
        CHECK(sum.radius == kInfinity);
    }
}

TEST_CASE("the translational gradient under a finite ceiling matches the closed form") {
    // Under the half x > 0 of a ceiling at height h that gives radiance 1, irradiance at x is pi (1 + x / sqrt(x^2 +
    // h^2)) / 2. Beyond the ceiling's edge everything is dark and far away.
    const float h = 1.5f;
    for (const float x : {-1.0f, -0.3f, 0.0f, 0.8f}) {
        for (const float turn : {0.0f, 0.7f, 2.0f}) { // rotation of the frame: the gradient belongs to the world
            CAPTURE(x);
            CAPTURE(turn);
            const Frame frame = {{std::cos(turn), std::sin(turn), 0}, {-std::sin(turn), std::cos(turn), 0}, {0, 0, 1}};
            const HemisphereSum sum = sum_over(kFine, frame, [&](Vec3 w) {
                const float t = h / w.z;
                const bool meets = x + t * w.x > 0;
                return HemisphereCell{grey(meets ? 1.0f : 0.0f), meets ? t : 1e4f};
            });
            const float far = std::sqrt(x * x + h * h);
            CHECK(sum.light.r == doctest::Approx(0.5 * (1 + static_cast<double>(x / far))).epsilon(0.02));
            check_near(sum.by_move[0], {0.5f * h * h / (far * far * far), 0, 0}, 0.02f);
        }
    }
}

TEST_CASE("a record's radius is the harmonic mean of distances, within its limits and its gradient's") {
    HemisphereSum sum = sum_over(kFine, make_frame(Vec3{0, 0, 1}), [](Vec3 w) {
        return HemisphereCell{{1, 1, 1}, w.x > 0 ? 1.0f : 3.0f};
    });
    CHECK(sum.radius == doctest::Approx(1.5).epsilon(1e-3)); // 2 / (1 + 1/3)
    HemisphereSum limited = sum;
    limit_radius(limited, 0.1f, 1.2f);
    CHECK(limited.radius == doctest::Approx(1.2));
    for (Vec3& move : sum.by_move) move = {0, 4, 0};
    limited = sum;
    limit_radius(limited, 0.1f, 9); // light 1 changes by its own amount over 1/4 m
    CHECK(limited.radius == doctest::Approx(0.25));
    check_near(limited.by_move[1], {0, 4, 0}, 1e-6f);
    limited = sum;
    limit_radius(limited, 0.5f, 9); // kept twice as large: half the gradient
    CHECK(limited.radius == doctest::Approx(0.5));
    check_near(limited.by_move[1], {0, 2, 0}, 1e-5f);
}

TEST_CASE("radii are clamped by those of their neighbours, in any order") {
    test::Random random(3);
    std::vector<Sphere> records;
    for (int i = 0; i < 700; ++i) {
        const float x = random.unit(), y = random.unit(), z = random.unit();
        const float share = random.unit();
        records.push_back({{x, y, 0.1f * z}, 0.001f + 0.5f * share * share * share});
    }
    const std::vector<float> clamped = clamped_radii(records);
    int smaller = 0;
    for (std::size_t i = 0; i < records.size(); ++i) {
        float wanted = records[i].radius;
        for (const Sphere& other : records) {
            wanted = std::min(wanted, other.radius + length(other.centre - records[i].centre));
        }
        CHECK(clamped[i] == doctest::Approx(static_cast<double>(wanted)).epsilon(1e-5));
        if (clamped[i] < records[i].radius) ++smaller;
    }
    CHECK(smaller > 100);
}

TEST_CASE("work in parts is done once, in order and within its limit") {
    for (const PartSizes sizes : {PartSizes{7, 1000}, PartSizes{100, 100}, PartSizes{5000, 5000}}) {
        for (const int max_requested : {1, 2, 3, 1 << 20}) {
            uint64_t done = 0, longest = 0;
            int connections = 0, parts = 0;
            const bool went_on = do_in_parts(
                1003, sizes, [&] { return ++connections <= max_requested; },
                [&](uint64_t begin, uint64_t end) {
                    CHECK(begin == done);
                    CHECK(end > begin);
                    longest = std::max(longest, end - begin);
                    done = end;
                    ++parts;
                });
            CHECK(longest <= sizes.most);
            CHECK(went_on == (done == 1003 && connections <= max_requested));
            CHECK(connections == parts + 1); // before each part, and after the last
        }
    }
    CHECK_FALSE(do_in_parts(
        0, {1, 1}, [] { return false; }, [](uint64_t, uint64_t) { CHECK(false); }));
}

TEST_CASE("parts of work take about 0.1 s, however long each piece takes") {
    uint64_t longest = 0, shortest = 1 << 20;
    const auto take_a_millisecond = [](uint64_t pieces) {
        std::this_thread::sleep_for(std::chrono::milliseconds(pieces));
    };
    do_in_parts(
        700, {1, 700}, [] { return true; },
        [&](uint64_t begin, uint64_t end) {
            take_a_millisecond(end - begin);
            longest = std::max(longest, end - begin);
            if (begin >= 127 && end < 700) shortest = std::min(shortest, end - begin);
        });
    CHECK(longest >= 16);  // a machine under load sleeps longer
    CHECK(longest <= 128); // parts of 40 ms or more are not doubled
    CHECK(shortest > 1);
}

TEST_CASE("the time to space records grows linearly with their number for all radii") {
    const auto seconds_for = [](uint32_t count) {
        test::Random random(8);
        std::vector<Sphere> records;
        for (uint32_t i = 0; i < count; ++i) { // on a floor, with the distance to the nearer of two walls as radius
            const float x = 20 * random.unit(), z = 20 * random.unit();
            records.push_back({{x, 0, z}, 0.05f + 1.5f * std::min(x, z) * (0.8f + 0.4f * random.unit())});
        }
        const std::clock_t began = std::clock();
        const std::vector<float> clamped = clamped_radii(records);
        const auto seconds = static_cast<double>(std::clock() - began) / CLOCKS_PER_SEC;
        CHECK(clamped.size() == count);
        return seconds;
    };
    const UseThreads one(1);
    const double few = seconds_for(1 << 12), many = seconds_for(1 << 15);
    CAPTURE(few);
    CAPTURE(many);
    CHECK(many < 32 * few); // it would be 64 if each record examined all others
}

TEST_CASE("light between records is their weighted mean, and there is none outside their radii") {
    const auto record_at = [](Vec3 at, float light) {
        IrradianceRecord record = {};
        record.point = {at, {0, 0, 1}, 0, kBareDiffuse};
        record.light = {light, light, light};
        return record;
    };
    std::vector<IrradianceRecord> records = {record_at({0, 0, 0}, 1), record_at({1, 0, 0}, 3)};
    records[0].by_move[0] = {0.5f, 0, 0};
    records[0].by_turn[1] = {2, 0, 0};
    const std::vector<float> reaches = {0.8f, 0.8f};
    const PointOctree tree = build_point_octree(std::vector<Sphere>{{{0, 0, 0}, 0.8f}, {{1, 0, 0}, 0.8f}}, nobody());
    const IrradianceCacheView cache = {records.data(), reaches.data(), view_of(tree), 0.2f};
    const auto at = [&](float x, Vec3 normal = {0, 0, 1}, uint32_t scatterings = 0, float z = 0) {
        return look_up(cache, {{x, 0, z}, normal, scatterings, kBareDiffuse});
    };
    CHECK(at(0).weight == doctest::Approx(1)); // outside the other record's radius
    CHECK(at(0).light.r == doctest::Approx(1));
    CHECK(at(-0.4f).weight == doctest::Approx(0.5));
    CHECK(at(-0.4f).light.r == doctest::Approx(0.8)); // 1 - 0.4 * 0.5
    CHECK(at(-0.4f).light.g == doctest::Approx(1));
    CHECK(at(0.4f).light.r == doctest::Approx((0.5 * 1.2 + 0.25 * 3) / 0.75));
    CHECK(at(-0.81f).weight == 0);
    CHECK(at(1.9f).weight == 0);
    // Turned by a, the error is sqrt(1 - cos a) = sqrt(2) sin(a / 2): all of the accuracy at 16.26 degrees.
    const auto turned = [](float a) { return Vec3{std::sin(a), 0, std::cos(a)}; };
    CHECK(at(0, turned(0.1f)).weight == doctest::Approx(1 - std::sqrt(2) * std::sin(0.05) / 0.2).epsilon(1e-3));
    CHECK(at(0, turned(0.1f)).light.g == doctest::Approx(1 + 2 * std::sin(0.1)).epsilon(1e-3));
    CHECK(at(0, turned(0.28f)).weight > 0);
    CHECK(at(0, turned(0.29f)).weight == 0);
    CHECK(at(0, {0, 0, 1}, 1).weight == 0); // a point seen in a mirror has its own records
    // A point above a record may use it; a point below may be occluded in ways that the record does not see.
    CHECK(at(0, {0, 0, 1}, 0, 0.2f).weight > 0);
    CHECK(at(0, {0, 0, 1}, 0, -0.2f).weight == 0);
    CHECK(look_up(cache, {{0, 0, 0}, {0, 0, 1}, 0, 4}).weight == 0); // under a reflection
}

TEST_CASE("the overture's grids cover each pixel, and none twice in a round") {
    for (const auto& [width, height] : {std::pair(37u, 21u), std::pair(1u, 1u), std::pair(640u, 33u)}) {
        for (uint32_t round = 0; round < kOvertureRounds; ++round) {
            const OvertureGrid grid = make_overture_grid(round, width, height);
            std::vector<int> taken(std::size_t(width) * height);
            for (uint32_t i = 0; i < grid.count(); ++i) {
                REQUIRE(grid.pixel(i) < taken.size());
                CHECK(++taken[grid.pixel(i)] == 1);
            }
            if (kOvertureSteps[round] == 1) CHECK(grid.count() == width * height);
            if (kOvertureSteps[round] == 8 && width == 640) CHECK(grid.count() == 80 * 4);
        }
    }
}

namespace {

/// The integrator's picture and its lookups.
struct CacheRun {
    Messages messages;
    PreparedScene prepared;
    Queue queue = Queue::make_cpu();
    SceneOnDevice device;
    SceneTracer tracer;
    FilterTable filter;
    PictureView picture;
    IrradianceCacheIntegrator integrator;
    Film film;

    CacheRun(const Scene& scene, const Camera& camera, uint32_t size, const IrradianceCacheSettings& cache,
             uint32_t samples, uint32_t max_depth = 6)
        : prepared(prepare_scene(scene, {}, messages)), device(queue, prepared),
          tracer(queue, *prepared.structures, default_tracers(false)), filter(queue),
          integrator(queue, {{.max_depth = max_depth}, cache}, true, 1u << 20), film(queue, size, size, 0) {
        tracer.set_surfaces(device.view());
        picture = {device.view(),
                   make_camera_rays(camera, filter.set(PixelFilter::Box, 0.5f), size, size, prepared.centre)};
        integrator.begin(picture, tracer, samples);
        integrator.render(0, samples, film.view());
    }
};

} // namespace

TEST_CASE("host memory of records equals its prediction") {
    const Scene scene = test::room_with_ball(test::white(0.8f), test::white(0.5f), false);
    constexpr uint32_t kSize = 64;
    const CacheRun run(scene, test::room_camera(), kSize, {.accuracy = 0.01f, .hemisphere_rays = 16}, 1);
    REQUIRE(run.integrator.record_count() == max_records(kSize * kSize)); // the maximum number of records
    Queue dry = Queue::make_dry_run(false);
    IrradianceCacheIntegrator predicted(dry, {}, true, 1);
    predicted.reserve({.width = kSize, .height = kSize, .samples = 1});
    CHECK(predicted.host_bytes() == run.integrator.host_bytes());
    const std::size_t of_record = 2 * sizeof(PointOctreeNode) + 3 * sizeof(Sphere) + 7 * sizeof(float);
    CHECK(predicted.host_bytes() == max_records(kSize * kSize) * of_record);
}

TEST_CASE("irradiance at records equals brute force") {
    const Scene scene = test::room_with_ball(test::white(0.8f), test::white(0.5f), false);
    const CacheRun run(scene, test::room_camera(), 24, {.accuracy = 0.3f, .hemisphere_rays = 6000}, 1);
    const std::vector<IrradianceRecord> records = run.integrator.records();
    REQUIRE(records.size() > 30);
    Queue queue = Queue::make_cpu();
    int compared = 0;
    for (std::size_t i = 0; i < records.size(); i += records.size() / 12) {
        const CachePoint& point = records[i].point;
        const Vec3 at = point.position + run.prepared.centre;
        if (std::abs(point.normal.y - 1) > 1e-4f || at.y > 0.01f) continue; // only the floor, whose albedo is known
        RenderSettings settings; // light that is scattered at least twice, by path tracing from nearby
        settings.width = settings.height = 1;
        settings.filter = PixelFilter::Box;
        settings.path.max_depth = 6;
        settings.path.light = PathLight::Indirect;
        settings.samples = 1 << 14;
        const Camera camera = test::camera_down(at + Vec3{0, 1e-3f, 0}, 1e-4f);
        const RenderResult brute = render_picture(queue, run.prepared, camera, settings);
        for (int k = 0; k < 3; ++k) {
            const auto wanted = static_cast<double>(brute.picture.pixels[static_cast<std::size_t>(k)]) / 0.5;
            CAPTURE(k);
            CHECK(static_cast<double>(k == 0   ? records[i].light.r
                                      : k == 1 ? records[i].light.g
                                               : records[i].light.b) == doctest::Approx(wanted).epsilon(0.04));
        }
        ++compared;
    }
    CHECK(compared >= 3);
}

TEST_CASE("few lookups miss, and there are records behind mirrors and beneath layers") {
    const Scene scene = test::room_with_ball(test::of_roughness(MaterialKind::MetallicRoughness, 0),
                                             test::of_roughness(MaterialKind::MetallicRoughness, 0.4f), false);
    const CacheRun run(scene, test::room_camera(), 48, {.accuracy = 0.4f, .hemisphere_rays = 64}, 4);
    const std::vector<IrradianceRecord> records = run.integrator.records();
    CHECK(run.integrator.record_count() == records.size());
    CHECK(records.size() < 48 * 48 / 4);
    CHECK(run.integrator.missed_lookups() < 48 * 48 * 4 / 50);
    CHECK(std::ranges::any_of(records, [](const IrradianceRecord& r) { return r.point.scatterings == 1; }));
    CHECK(std::ranges::any_of(records, [](const IrradianceRecord& r) { return r.point.material != kBareDiffuse; }));
    for (const IrradianceRecord& record : records) {
        CHECK(record.radius > 0);
        CHECK(record.light.r >= 0);
        CHECK(is_finite(record.by_move[0]));
        CHECK(length(record.point.normal) == doctest::Approx(1).epsilon(1e-4));
    }
}

TEST_CASE("in a glowing room each scattering counts once, with records and with the paths that replace them") {
    const test::TriangleMesh sphere = test::make_sphere(3, {0, 0, 0}, 2.0f);
    Scene scene;
    Mesh mesh;
    mesh.positions = sphere.positions;
    mesh.indices = sphere.indices;
    test::add(scene, mesh, {{.two_sided_emission = true, .base_color = grey(0.5f), .emission = {1, 1, 1}}, "wall"});
    for (const bool has_all : {true, false}) { // records would have a radius below a pixel
        double wanted = 0;
        for (uint32_t depth = 0; depth <= 4; ++depth) {
            CAPTURE(has_all);
            CAPTURE(depth);
            wanted += std::pow(0.5, depth);
            constexpr uint32_t kSamples = 32;
            CacheRun run(scene, test::camera_down({0.3f, 0.2f, -0.5f}, 0.4f), 8,
                         {.accuracy = has_all ? 0.25f : 0.01f, .hemisphere_rays = 256}, kSamples, depth);
            double sum = 0;
            for (uint32_t i = 0; i < 64; ++i) {
                sum += static_cast<double>(mean_of(run.film.view().pixel(i)[0], kSamples)) / 64;
            }
            CHECK(sum == doctest::Approx(wanted).epsilon(0.01));
            if (depth >= 2) CHECK((run.integrator.missed_lookups() > 64 * kSamples / 8) == !has_all);
        }
    }
}

TEST_CASE("marks are drawn only where records are visible") {
    const Scene scene = test::room_with_ball(test::white(0.8f), test::white(0.5f), false);
    constexpr uint32_t kSize = 64;
    IrradianceCacheSettings cache = {.accuracy = 0.8f, .hemisphere_rays = 32};
    CacheRun plain(scene, test::room_camera(), kSize, cache, 2, 2);
    cache.show_records = true;
    CacheRun marked(scene, test::room_camera(), kSize, cache, 2, 2);
    std::vector<double> nearest(std::size_t(kSize) * kSize, 1e9); // record, pixels
    std::vector<bool> has_record(nearest.size());
    for (const IrradianceRecord& record : plain.integrator.records()) {
        const ProjectedPoint seen = project_point(plain.picture.camera.view, record.point.position);
        has_record[static_cast<std::size_t>(seen.pixel.y) * kSize + static_cast<std::size_t>(seen.pixel.x)] = true;
        for (std::size_t i = 0; i < nearest.size(); ++i) {
            const double x = static_cast<double>(i % kSize) + 0.5 - static_cast<double>(seen.pixel.x);
            const double y = static_cast<double>(i / kSize) + 0.5 - static_cast<double>(seen.pixel.y);
            nearest[i] = std::min(nearest[i], std::hypot(x, y));
        }
    }
    int with_record = 0, changed = 0, far = 0;
    for (std::size_t i = 0; i < nearest.size(); ++i) {
        const auto pixel = static_cast<uint32_t>(i);
        const bool is_same = std::equal(plain.film.view().pixel(pixel), plain.film.view().pixel(pixel) + 3,
                                        marked.film.view().pixel(pixel));
        if (has_record[i]) {
            ++with_record;
            if (!is_same) ++changed;
        }
        if (nearest[i] < 3) continue; // a mark's radius is 1.25 pixels, a sample's place up to 0.7 from the middle
        ++far;
        CHECK(is_same);
    }
    CHECK(with_record > 20);
    CHECK(changed > with_record * 9 / 10); // the others are at an edge
    CHECK(far > 200);
}

TEST_CASE(
    "the overture's progress is its share of all rays, while ever fewer records are needed or until memory is full") {
    constexpr uint32_t kWidth = 640, kHeight = 360, kTraversal = 2, kRecord = 500;
    struct Case {
        double falls_by;
        uint32_t room;
    };
    for (const Case& set : {Case{0.9, 100000}, Case{0.7, 100000}, Case{0.9, 3000}, Case{0, 100000}}) {
        CAPTURE(set.falls_by);
        CAPTURE(set.room);
        uint32_t wanted[kOvertureRounds], counts[kOvertureRounds], records = 0;
        uint64_t all = 0;
        double share = 0.9, fall = set.falls_by;
        for (uint32_t round = 0; round < kOvertureRounds; ++round) {
            counts[round] = make_overture_grid(round, kWidth, kHeight).count();
            if (round > 1) share *= std::exchange(fall, std::pow(fall, 1.75));
            wanted[round] = std::min(static_cast<uint32_t>(share * counts[round]), set.room - records);
            records += wanted[round];
            all += uint64_t(kTraversal) * counts[round] + uint64_t(kRecord) * wanted[round];
        }
        OvertureProgress progress(kWidth, kHeight, 100, set.room);
        uint64_t rays = 0;
        double before = 0;
        const auto check = [&](bool is_known) {
            const double reported = progress.share(rays), done = static_cast<double>(rays) / static_cast<double>(all);
            CHECK(reported >= before);
            before = reported;
            if (is_known) CHECK(reported == doctest::Approx(done).epsilon(0.1));
        };
        for (uint32_t round = 0; round < kOvertureRounds; ++round) {
            const bool is_known = round > 2; // the rate of decrease is
            progress.begin_subpaths(rays);
            for (uint32_t i = 0; i < counts[round]; ++i) {
                if (i % 100 == 0) check(is_known);
                rays += kTraversal;
            }
            progress.begin_records(wanted[round], rays);
            for (uint32_t i = 0; i < wanted[round]; ++i) {
                if (i % 10 == 0) check(is_known);
                rays += kRecord;
            }
        }
        CHECK(rays == all);
        check(true);
        CHECK(before == 0.999);
        CHECK(progress.share(rays + 1000 * kRecord) < 1); // more records than expected, so the work is not complete
    }
}
