// Photons in the order of their numbers, the hash grid over them, and the selection in dense cells.

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "integrators/photon_map/order_photons.h"
#include "tests/support/random.h"
#include "tests/support/stress_points.h"

using namespace pertev;

namespace {

struct GridOfPoints {
    std::vector<Float4> positions, points;
    std::vector<uint32_t> starts;
    PhotonGridView view;

    std::vector<Float4> powers; // the kept photons have the power of all photons

    GridOfPoints(const std::vector<Vec3>& from, float radius, float largest, uint32_t max_kept = 0xffffffffu,
                 uint32_t pass = 0) {
        Queue queue = Queue::make_cpu();
        const auto count = static_cast<uint32_t>(from.size());
        for (const Vec3 p : from) positions.push_back({p.x, p.y, p.z, 0});
        const PhotonCells cells = make_photon_cells(radius, largest, count);
        std::vector<uint64_t> keys(count), sorted_keys(count);
        std::vector<uint32_t> order(count), sorted_order(count);
        for (uint32_t i = 0; i < count; ++i) MakeBuckets{positions.data(), cells, keys.data(), order.data()}(i);
        Buffer<std::byte> scratch;
        sort_photons(queue, scratch, keys.data(), order.data(), sorted_keys.data(), sorted_order.data(), count, 31);
        points.resize(count);
        powers.assign(count, {1, 1, 1, 0});
        starts.assign(cells.buckets + 1, 77);
        for (uint32_t i = 0; i <= count; ++i) {
            FindBuckets{sorted_keys.data(), count, cells.buckets, starts.data()}(i);
        }
        for (uint32_t i = 0; i < count; ++i) {
            KeepPhotons{{positions.data(), nullptr, powers.data()},
                        sorted_keys.data(),
                        sorted_order.data(),
                        starts.data(),
                        max_kept,
                        pass,
                        9,
                        points.data()}(i);
        }
        view = {cells, points.data(), starts.data(), max_kept};
    }
};

} // namespace

TEST_CASE("a hash grid matches brute force over all photons, with ties by number") {
    for (const test::StressPoints& set : test::stress_points(600)) {
        if (set.extent < 1e-30f)
            continue; // the squares of such distances are 0, so every photon is near every other, but not in a grid
        CAPTURE(set.name);
        for (const float share : {1e-6f, 0.1f, 0.25f, 1.0f}) {
            const float radius = share * set.extent;
            const GridOfPoints grid(set.points, radius, 2 * set.extent);
            for (const Vec3 at : test::query_points(set, 60)) {
                const std::vector<NearPoint> want = test::within_by_brute_force(set.points, at, radius);
                std::vector<NearPoint> seen;
                visit_within(grid.view, at, radius, [&](const NearPoint& p) { seen.push_back(p); });
                std::ranges::sort(seen, is_nearer);
                REQUIRE(seen == want);
                for (const uint32_t k : {1u, 7u, 700u}) {
                    std::vector<NearPoint> nearest(k);
                    nearest.resize(find_nearest(grid.view, at, radius, k, nearest.data()));
                    REQUIRE(nearest.size() == std::min<std::size_t>(k, want.size()));
                    REQUIRE(std::equal(nearest.begin(), nearest.end(), want.begin()));
                }
            }
        }
    }
}

TEST_CASE("a crowded bucket keeps the requested number of photons, chosen uniformly, with the total power") {
    test::Random random(12);
    std::vector<Vec3> points;
    for (int i = 0; i < 700; ++i) points.push_back(random.point(0, 1));
    for (int i = 0; i < 40; ++i) points.push_back(random.point(0, 1) + Vec3{30, 0, 0});
    constexpr uint32_t kMaxNear = 48, kPasses = 4000;
    constexpr float kRadius = 0.4f;
    std::vector<uint32_t> stayed(points.size());
    for (uint32_t pass = 0; pass < kPasses; ++pass) {
        const GridOfPoints grid(points, kRadius, 40, kMaxNear, pass);
        std::vector<uint32_t> found;
        for (const float x : {0.0f, 0.6f, 1.2f, 30.0f, 30.6f, 31.2f}) {
            for (const float y : {0.0f, 0.6f, 1.2f}) {
                for (const float z : {0.0f, 0.6f, 1.2f}) {
                    visit_buckets(grid.view, {x, y, z}, [&](uint32_t begin, uint32_t end) {
                        CHECK(end - begin <= kMaxNear);
                        for (uint32_t i = begin; i < end; ++i) found.push_back(bits_of(grid.points[i].w));
                    });
                }
            }
        }
        std::ranges::sort(found);
        found.erase(std::unique(found.begin(), found.end()), found.end());
        std::vector<uint32_t> those_that_stay;
        double power = 0;
        for (uint32_t i = 0; i < points.size(); ++i) {
            if (grid.positions[i].w == 0) continue;
            those_that_stay.push_back(i);
            power += static_cast<double>(grid.powers[i].x);
            ++stayed[i];
        }
        CHECK(found == those_that_stay);
        CHECK(power == doctest::Approx(740).epsilon(1e-5));
    }
    const GridOfPoints all(points, kRadius, 40), some(points, kRadius, 40, kMaxNear);
    uint32_t thinned = 0;
    for (uint32_t i = 0; i < points.size(); ++i) {
        const Float4 p = all.positions[i];
        const uint32_t bucket = all.view.cells.bucket_of({p.x, p.y, p.z});
        const uint32_t n = all.starts[bucket + 1] - all.starts[bucket];
        const double chance = n > kMaxNear ? static_cast<double>(kMaxNear) / n : 1;
        thinned += n > kMaxNear ? 1 : 0;
        CHECK(stayed[i] == doctest::Approx(kPasses * chance).epsilon(5 / std::sqrt(kPasses * chance)));
        if (n <= kMaxNear) CHECK(stayed[i] == kPasses);
        if (n <= kMaxNear) CHECK(some.powers[i].x == 1);
    }
    CHECK(thinned > 500);
    CHECK(thinned < points.size());
}

TEST_CASE("photons are sorted by their numbers, whatever their order of arrival") {
    Queue queue = Queue::make_cpu();
    test::Random random(4);
    std::vector<std::pair<uint64_t, uint32_t>> wanted;
    std::vector<uint64_t> keys, sorted_keys(5000);
    std::vector<uint32_t> order, sorted_order(5000);
    for (uint32_t i = 0; i < 5000; ++i) {
        keys.push_back(photon_key(random.below(1u << 25), random.below(64)));
        order.push_back(i);
        wanted.emplace_back(keys.back(), i);
    }
    std::ranges::sort(wanted);
    Buffer<std::byte> scratch;
    sort_photons(queue, scratch, keys.data(), order.data(), sorted_keys.data(), sorted_order.data(), 5000, 34);
    for (uint32_t i = 0; i < 5000; ++i) {
        CHECK(wanted[i] == std::pair(sorted_keys[i], sorted_order[i]));
    }
}
