#pragma once

// The vertices of a scene's instances in the world, where those that only rounding has put apart are one: neighbours
// in meshes of their own, or placed by transforms of their own.

#include <cstdint>
#include <vector>

#include "device_scene/scene_view.h"

namespace pertev {

class WeldedVertices {
public:
    /// Two vertices are one where no coordinate differs by more than kWeld of the largest coordinate, whatever the size
    /// of the scene; each takes the place of the first.
    explicit WeldedVertices(const SceneView& scene);

    /// Metres.
    void corners(uint32_t instance, uint32_t primitive, Vec3 (&at)[3]) const;

    static constexpr float kWeld = 0x1p-22f; // four roundings of floats
    /// Of so many vertices, at most.
    static std::size_t most_bytes(uint64_t vertices) { return vertices * (2 * sizeof(Vec3) + 4 * sizeof(uint32_t)); }

private:
    const SceneView& scene_;
    std::vector<uint64_t> first_; // [instances] of its vertices in at_
    std::vector<Vec3> at_;
};

} // namespace pertev
