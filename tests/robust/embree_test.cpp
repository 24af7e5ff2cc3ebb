// Hits agree with Embree's robust single-ray walk: another primitive only where both lie at one t or the ray meets an
// edge; of the rest at most 10 in 10^7. One t: within 1e-5 of it, or within 4 units in the last place of the
// coordinates that it is computed from (Sponza has walls that are there twice, and rays that start just before them).

// PERTEV_EMBREE is 3 or 4; without Embree this file is not built.

#include <doctest/doctest.h>
#if PERTEV_EMBREE == 4
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

#include <algorithm>
#include <cmath>

#include "accel/bvh/build_bvh.h"
#include "base/parallel_for.h"
#include "tests/support/meshes.h"
#include "tests/support/options.h"
#include "trace/trace_any.h"
#include "trace/trace_closest.h"

using namespace pertev;
using namespace pertev::test;

namespace {

class EmbreeScene {
public:
    explicit EmbreeScene(const TriangleMesh& mesh) {
        RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
        auto* v = static_cast<Vec3*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                                             sizeof(Vec3), mesh.positions.size()));
        std::copy(mesh.positions.begin(), mesh.positions.end(), v);
        auto* k = static_cast<uint32_t*>(
            rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 12, mesh.triangle_count()));
        std::copy(mesh.indices.begin(), mesh.indices.end(), k);
        rtcCommitGeometry(geometry);
        rtcAttachGeometry(scene_, geometry);
        rtcReleaseGeometry(geometry);
        rtcSetSceneFlags(scene_, RTC_SCENE_FLAG_ROBUST);
        rtcCommitScene(scene_);
    }
    ~EmbreeScene() {
        rtcReleaseScene(scene_);
        rtcReleaseDevice(device_);
    }
    EmbreeScene(const EmbreeScene&) = delete;
    EmbreeScene& operator=(const EmbreeScene&) = delete;

    RTCRayHit trace(const Ray& r) const {
        RTCRayHit result;
        result.ray = {r.origin.x, r.origin.y,  r.origin.z, r.t_min, r.direction.x, r.direction.y, r.direction.z, 0,
                      r.t_max,    0xffffffffu, 0,          0};
        result.hit.geomID = RTC_INVALID_GEOMETRY_ID;
#if PERTEV_EMBREE == 4
        rtcIntersect1(scene_, &result);
#else
        RTCIntersectContext context;
        rtcInitIntersectContext(&context);
        rtcIntersect1(scene_, &context, &result);
#endif
        return result;
    }

private:
    RTCDevice device_ = rtcNewDevice(nullptr);
    RTCScene scene_ = rtcNewScene(device_);
};

struct Tally {
    uint64_t hits = 0, other = 0, unexplained = 0;
};

/// Least weight of the hit's three vertices: near 0 on an edge.
float edge_distance(float u, float v) { return min(min(u, v), 1 - u - v); }

Tally compare(const TriangleMesh& mesh, uint64_t count) {
    const EmbreeScene embree(mesh);
    const Bvh bvh = build_bvh(triangles_of(mesh));
    SceneBvhView scene;
    scene.baked = view_of(bvh);
    const float last_place = 4 * 0x1p-23f * bvh.bounds.max_abs();
    constexpr uint64_t kBlock = 10000;
    std::vector<Tally> tallies((count + kBlock - 1) / kBlock);
    parallel_for(tallies.size(), 1, [&](uint64_t block) {
        Random random(static_cast<uint32_t>(block) * 2654435761u + 5);
        Tally& tally = tallies[block];
        for (uint64_t i = 0; i < kBlock; ++i) {
            Ray ray;
            const Vec3 size = bvh.bounds.size();
            ray.origin = bvh.bounds.lo + Vec3{size.x * random.unit(), size.y * random.unit(), size.z * random.unit()};
            ray.direction = random.direction();
            Hit hit;
            trace_closest(scene, ray, AcceptAll{}, hit);
            const RTCRayHit want = embree.trace(ray);
            const bool found = hit.instance != kNoHit, expected = want.hit.geomID != RTC_INVALID_GEOMETRY_ID;
            tally.hits += found ? 1 : 0;
            if (found == expected && (!found || hit.primitive == want.hit.primID)) continue;
            ++tally.other;
            const bool same_t = found && expected && pertev::abs(hit.t - want.ray.tfar) <= max(1e-5f * hit.t, last_place);
            const bool on_edge = (found && pertev::abs(edge_distance(hit.u, hit.v)) < 1e-4f) ||
                                 (expected && pertev::abs(edge_distance(want.hit.u, want.hit.v)) < 1e-4f);
            if (!same_t && !on_edge) ++tally.unexplained;
        }
    });
    Tally sum;
    for (const Tally& t : tallies) {
        sum.hits += t.hits;
        sum.other += t.other;
        sum.unexplained += t.unexplained;
    }
    MESSAGE(count, " rays: ", sum.hits, " hits, ", sum.other, " on another primitive, ", sum.unexplained,
            " of them neither at one t nor on an edge");
    return sum;
}

} // namespace

TEST_CASE("hits on a torus agree with Embree's") {
    const uint64_t count = effort(300'000, 10'000'000);
    const Tally tally = compare(make_torus(300, 200), count);
    CHECK(tally.hits > count / 10);
    CHECK(tally.unexplained <= std::max<uint64_t>(1, count / 1'000'000));
}

TEST_CASE("hits in Sponza agree with Embree's") {
    const auto path = test_scene("crytek-sponza/sponza.obj");
    if (!path) return;
    const uint64_t count = effort(1'000'000, 10'000'000);
    const Tally tally = compare(read_obj_geometry(*path), count);
    CHECK(tally.hits > count / 2);
    CHECK(tally.unexplained <= std::max<uint64_t>(1, count / 1'000'000));
}
