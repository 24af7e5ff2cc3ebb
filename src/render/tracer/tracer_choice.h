#pragma once

// Which tracer pictures take for each kind of ray. The choice changes no picture.

#include <cstdint>

#include "render/tracer/combination.h"

namespace pertev {

enum class RayKind : uint8_t { Camera, Bounce, Shadow };
inline constexpr RayKind kRayKinds[] = {RayKind::Camera, RayKind::Bounce, RayKind::Shadow};

struct TracerChoice {
    Combination camera, bounce, shadow;

    const Combination& operator[](RayKind kind) const;
    bool operator==(const TracerChoice&) const = default;
};

/// The one for all kinds of ray.
TracerChoice same_for_all(const Combination& combination);
/// What is fastest for most scenes, by docs/performance.md.
TracerChoice default_tracers(bool on_cuda);

/// Whether a loop on the host may walk what is chosen ray by ray (render/find_hit.h): one structure, eight boxes at a
/// time, every switch on.
bool can_walk_on_host(const TracerChoice& choice, bool on_cuda);

/// Throws Error(BadInput) that says why where a tracer that was chosen makes no sense there, was not compiled, or has
/// tests that leak.
void check_choice(const TracerChoice& choice, bool on_cuda);

} // namespace pertev
