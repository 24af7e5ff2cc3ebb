#include "bench/embree_peer.h"

#include <algorithm>
#include <array>

namespace pertev::bench {
namespace {

constexpr std::size_t kStream = 256; // rays a call; from 64 to 4096 its speed is the same within 5 %

/// Ray `at` of a packet.
template <class Packet>
void set_ray(Packet& p, std::size_t at, const Ray& r) {
    p.ray.org_x[at] = r.origin.x, p.ray.org_y[at] = r.origin.y, p.ray.org_z[at] = r.origin.z;
    p.ray.dir_x[at] = r.direction.x, p.ray.dir_y[at] = r.direction.y, p.ray.dir_z[at] = r.direction.z;
    p.ray.tnear[at] = r.t_min, p.ray.tfar[at] = r.t_max;
    p.ray.time[at] = 0, p.ray.mask[at] = ~0u, p.ray.id[at] = 0, p.ray.flags[at] = 0;
    p.hit.geomID[at] = p.hit.instID[0][at] = RTC_INVALID_GEOMETRY_ID;
}

template <std::size_t kSize, class Packet>
std::vector<Packet> make_packets(std::span<const Ray> rays) {
    std::vector<Packet> packets((rays.size() + kSize - 1) / kSize);
    for (std::size_t i = 0; i < packets.size() * kSize; ++i) {
        Ray ray = rays[std::min(i, rays.size() - 1)];
        if (i >= rays.size()) ray.t_max = -1; // switched off
        set_ray(packets[i / kSize], i % kSize, ray);
    }
    return packets;
}

template <std::size_t kSize, class Packet>
std::size_t count_in_packets(const std::vector<Packet>& packets, std::size_t count, bool any_hit) {
    std::size_t hits = 0;
    for (std::size_t i = 0; i < count; ++i) {
        const Packet& p = packets[i / kSize];
        const bool is_hit = any_hit ? p.ray.tfar[i % kSize] < 0 : p.hit.geomID[i % kSize] != RTC_INVALID_GEOMETRY_ID;
        hits += is_hit ? 1 : 0;
    }
    return hits;
}

#if PERTEV_EMBREE == 4
struct Arguments {
    RTCIntersectArguments closest;
    RTCOccludedArguments any;
    explicit Arguments(bool coherent) {
        rtcInitIntersectArguments(&closest);
        rtcInitOccludedArguments(&any);
        closest.flags = any.flags = coherent ? RTC_RAY_QUERY_FLAG_COHERENT : RTC_RAY_QUERY_FLAG_INCOHERENT;
    }
};
#endif

} // namespace

const char* name_of(EmbreeWay way) {
    switch (way) {
    case EmbreeWay::Single:
        return "single";
    case EmbreeWay::Packets8:
        return "packets of 8";
    case EmbreeWay::Packets16:
        return "packets of 16";
    case EmbreeWay::Stream:
        break;
    }
    return "stream";
}

EmbreeRays make_embree_rays(EmbreeWay way, std::span<const Ray> rays, bool any_hit, bool coherent) {
    EmbreeRays made;
    made.any_hit = any_hit;
    made.coherent = coherent;
    made.count = rays.size();
    switch (way) {
    case EmbreeWay::Single:
    case EmbreeWay::Stream:
        for (const Ray& r : rays) {
            RTCRayHit& to = made.singles.emplace_back();
            to.ray = {.org_x = r.origin.x,
                      .org_y = r.origin.y,
                      .org_z = r.origin.z,
                      .tnear = r.t_min,
                      .dir_x = r.direction.x,
                      .dir_y = r.direction.y,
                      .dir_z = r.direction.z,
                      .time = 0,
                      .tfar = r.t_max,
                      .mask = ~0u,
                      .id = 0,
                      .flags = 0};
            to.hit.geomID = to.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
        }
        break;
    case EmbreeWay::Packets8:
        made.of_8 = make_packets<8, RTCRayHit8>(rays);
        break;
    case EmbreeWay::Packets16:
        made.of_16 = make_packets<16, RTCRayHit16>(rays);
        break;
    }
    return made;
}

std::size_t count_hits(EmbreeWay way, const EmbreeRays& rays) {
    switch (way) {
    case EmbreeWay::Packets8:
        return count_in_packets<8>(rays.of_8, rays.count, rays.any_hit);
    case EmbreeWay::Packets16:
        return count_in_packets<16>(rays.of_16, rays.count, rays.any_hit);
    case EmbreeWay::Single:
    case EmbreeWay::Stream:
        break;
    }
    return static_cast<std::size_t>(std::ranges::count_if(rays.singles, [&](const RTCRayHit& r) {
        return rays.any_hit ? r.ray.tfar < 0 : r.hit.geomID != RTC_INVALID_GEOMETRY_ID;
    }));
}

EmbreePeer::EmbreePeer(const Mesh& mesh, bool robust) : device_(rtcNewDevice(nullptr)), scene_(rtcNewScene(device_)) {
    RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
    auto* v = static_cast<Vec3*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                                         sizeof(Vec3), mesh.positions.size()));
    std::ranges::copy(mesh.positions, v);
    auto* k = static_cast<uint32_t*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                                             3 * sizeof(uint32_t), mesh.indices.size() / 3));
    std::ranges::copy(mesh.indices, k);
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene_, geometry);
    rtcReleaseGeometry(geometry);
    rtcSetSceneFlags(scene_, robust ? RTC_SCENE_FLAG_ROBUST : RTC_SCENE_FLAG_NONE);
    rtcSetSceneBuildQuality(scene_, RTC_BUILD_QUALITY_HIGH);
    rtcCommitScene(scene_);
}

EmbreePeer::~EmbreePeer() {
    rtcReleaseScene(scene_);
    rtcReleaseDevice(device_);
}

void EmbreePeer::trace(EmbreeWay way, EmbreeRays& rays) const {
    alignas(64) static constexpr auto kAllOn = [] {
        std::array<int, 16> valid;
        valid.fill(-1);
        return valid;
    }();
#if PERTEV_EMBREE == 4
    Arguments arguments(rays.coherent);
    auto* const closest = &arguments.closest;
    auto* const any = &arguments.any;
    const auto intersect_1 = [&](RTCRayHit& r) { rtcIntersect1(scene_, &r, closest); };
    const auto occluded_1 = [&](RTCRayHit& r) { rtcOccluded1(scene_, &r.ray, any); };
    const auto intersect_8 = [&](RTCRayHit8& p) { rtcIntersect8(kAllOn.data(), scene_, &p, closest); };
    const auto occluded_8 = [&](RTCRayHit8& p) { rtcOccluded8(kAllOn.data(), scene_, &p.ray, any); };
    const auto intersect_16 = [&](RTCRayHit16& p) { rtcIntersect16(kAllOn.data(), scene_, &p, closest); };
    const auto occluded_16 = [&](RTCRayHit16& p) { rtcOccluded16(kAllOn.data(), scene_, &p.ray, any); };
#else
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    context.flags = rays.coherent ? RTC_INTERSECT_CONTEXT_FLAG_COHERENT : RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
    const auto intersect_1 = [&](RTCRayHit& r) { rtcIntersect1(scene_, &context, &r); };
    const auto occluded_1 = [&](RTCRayHit& r) { rtcOccluded1(scene_, &context, &r.ray); };
    const auto intersect_8 = [&](RTCRayHit8& p) { rtcIntersect8(kAllOn.data(), scene_, &context, &p); };
    const auto occluded_8 = [&](RTCRayHit8& p) { rtcOccluded8(kAllOn.data(), scene_, &context, &p.ray); };
    const auto intersect_16 = [&](RTCRayHit16& p) { rtcIntersect16(kAllOn.data(), scene_, &context, &p); };
    const auto occluded_16 = [&](RTCRayHit16& p) { rtcOccluded16(kAllOn.data(), scene_, &context, &p.ray); };
#endif
    const auto for_each = [&](auto& list, const auto& intersect, const auto& occluded) {
        if (rays.any_hit) {
            for (auto& r : list) occluded(r);
        } else {
            for (auto& r : list) intersect(r);
        }
    };
    switch (way) {
    case EmbreeWay::Single:
        for_each(rays.singles, intersect_1, occluded_1);
        break;
    case EmbreeWay::Packets8:
        for_each(rays.of_8, intersect_8, occluded_8);
        break;
    case EmbreeWay::Packets16:
        for_each(rays.of_16, intersect_16, occluded_16);
        break;
    case EmbreeWay::Stream:
#if PERTEV_EMBREE < 4
        for (std::size_t i = 0; i < rays.count; i += kStream) {
            const auto count = static_cast<unsigned>(std::min(kStream, rays.count - i));
            RTCRayHit* const first = rays.singles.data() + i;
            if (rays.any_hit) {
                rtcOccluded1M(scene_, &context, &first->ray, count, sizeof(RTCRayHit));
            } else {
                rtcIntersect1M(scene_, &context, first, count, sizeof(RTCRayHit));
            }
        }
#endif
        break;
    }
}

} // namespace pertev::bench
