#pragma once

// The stage that aims the camera rays of the small picture of the present scene (temporal_gradients.h) at what the
// picture of the earlier scene shows, where that has moved. Both then show the same points of surfaces. Through the
// same pixels they would show the same places, and an object that moves into light would seem to be in constant light.
//
// Source: Schied, Peters, Dachsbacher, "Gradient Estimation for Real-Time Adaptive Temporal Filtering", HPG 2018,
// section 3.1 (forward projection of gradient samples).

#include "denoise/reconstruction_view.h"

namespace pertev {

struct AimAtMoved {
    const Float4* hit; // GBufferView::hit of the picture of the earlier scene
    const InstanceView* instances;
    const MeshView* meshes;
    PreviousScene before;
    Float4* aims; // NoisyFrameView::aims

    HD void operator()(uint32_t i) const {
        const Float4 seen = hit[i];
        aims[i] = {0, 0, 0, 0};
        if (bits_of(seen.x) == kNoHit) return;
        const Vec3 is = point_at(instances, meshes, seen), was = point_at(before.instances, before.meshes, seen);
        if (is.x != was.x || is.y != was.y || is.z != was.z) aims[i] = {is.x, is.y, is.z, 1};
    }
};

} // namespace pertev
