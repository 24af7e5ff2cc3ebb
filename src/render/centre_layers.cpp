#include "render/centre_layers.h"

#include <algorithm>

#include "base/error.h"
#include "device/launch.h"

namespace pertev {

float*& CentreArrays::of(AovBits group) {
    switch (group) {
    case kAovAlbedo:
        return albedo;
    case kAovNormal:
        return normal;
    case kAovDepth:
        return depth;
    case kAovPosition:
        return position;
    case kAovDistance:
        return distance;
    case kAovIds:
    case kAovMotion:
        break;
    }
    PERTEV_CHECK(false);
    return albedo;
}

void CentreLayers::reserve(uint64_t pixels, bool has_times) {
    const auto rays = static_cast<std::size_t>(std::min<uint64_t>(pixels, at_once_));
    rays_.grow(queue_, rays, "rays through centres");
    keys_.grow(queue_, rays, "rays through centres");
    records_.grow(queue_, rays, "hits of centres");
    instances_.grow(queue_, rays, "hits of centres");
    if (has_times) times_.grow(queue_, rays, "rays through centres");
}

void CentreLayers::find(const PictureView& picture, SceneTracer& tracer, uint32_t seed, const PixelWindow& window,
                        const CentreArrays& into) {
    const SceneView& scene = picture.scene;
    const bool has_times = scene.motions.is_there();
    reserve(window.count(), has_times);
    uint32_t* const keys = scene.any_alpha != 0 ? keys_.data() : nullptr;
    float* const times = has_times ? times_.data() : nullptr;
    const HitQueueView hits = {records_.data(), instances_.data()};
    for (uint32_t first = 0; first < window.count(); first += at_once_) {
        const uint32_t count = std::min(window.count() - first, at_once_);
        launch(queue_, "make_centre_rays", count,
               MakeCentreRays{picture, seed, window, first, rays_.data(), keys, times});
        tracer.find_hits(RayKind::Camera, {.rays = rays_.data(), .keys = keys, .times = times, .is_endless = true},
                         count, hits);
        const auto store = [&]<ShadingVariant kVariant, bool kMoves>() {
            launch(queue_, "store_centres", count,
                   StoreCentres<kVariant, kMoves>{picture, rays_.data(), hits, window, into});
        };
        if (has_times) {
            store.template operator()<ShadingVariant::General, true>();
            continue;
        }
        switch (scene.variant) {
        case ShadingVariant::PlainDiffuse:
            store.template operator()<ShadingVariant::PlainDiffuse, false>();
            break;
        case ShadingVariant::General:
        case ShadingVariant::Unstacked:
        case ShadingVariant::Diffuse:
            store.template operator()<ShadingVariant::General, false>();
            break;
        }
    }
}

} // namespace pertev
