#pragma once

// Embree 3 or 4 as the tracer that ours is measured against: one mesh in a tree of high quality, with or without its
// robust flag, and every way that it takes rays on one thread.

#if PERTEV_EMBREE == 4
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

#include <span>
#include <vector>

#include "scene/mesh.h"
#include "trace/intersect/ray.h"

namespace pertev::bench {

enum class EmbreeWay {
    Single,    // one call a ray
    Packets8,  // eight rays a call
    Packets16, // sixteen
    Stream,    // many rays a call: rtcIntersect1M; Embree 4 has none
};
#if PERTEV_EMBREE == 4
inline constexpr EmbreeWay kBatchedWays[] = {EmbreeWay::Packets8, EmbreeWay::Packets16};
#else
inline constexpr EmbreeWay kBatchedWays[] = {EmbreeWay::Packets8, EmbreeWay::Packets16, EmbreeWay::Stream};
#endif
const char* name_of(EmbreeWay way);

/// Rays in the form that a way takes, which making them is not part of its time. trace() overwrites them.
struct EmbreeRays {
    bool any_hit = false;
    bool coherent = false; // flag passed to Embree
    std::size_t count = 0;
    std::vector<RTCRayHit> singles;
    std::vector<RTCRayHit8> of_8; // see of_16; in the last packet the missing rays are switched off
    std::vector<RTCRayHit16> of_16;
};
EmbreeRays make_embree_rays(EmbreeWay way, std::span<const Ray> rays, bool any_hit, bool coherent);

class EmbreePeer {
public:
    EmbreePeer(const Mesh& mesh, bool robust);
    ~EmbreePeer();
    EmbreePeer(const EmbreePeer&) = delete;
    EmbreePeer& operator=(const EmbreePeer&) = delete;

    void trace(EmbreeWay way, EmbreeRays& rays) const;

private:
    RTCDevice device_;
    RTCScene scene_;
};

/// Number of traced rays that hit something.
std::size_t count_hits(EmbreeWay way, const EmbreeRays& rays);

} // namespace pertev::bench
