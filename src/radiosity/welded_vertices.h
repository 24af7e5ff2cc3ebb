#pragma once

// World-space vertices of a scene's instances, in which those that differ only by rounding are merged: neighbours in
// different meshes, or under different transforms.

#include <cstdint>
#include <vector>

#include "device_scene/scene_view.h"

namespace pertev {

class WeldedVertices {
public:
    /// Merges the vertices of a scene. Two vertices are merged if no coordinate differs by more than kWeld of the
    /// largest coordinate, whatever the size of the scene; each takes the position of the first.
    explicit WeldedVertices(const SceneView& scene);

    /// Writes the corners of a triangle, in metres.
    void corners(uint32_t instance, uint32_t primitive, Vec3 (&at)[3]) const;

    static constexpr float kWeld = 0x1p-22f; // four roundings of floats
    /// Maximum bytes for a number of vertices.
    static std::size_t max_bytes(uint64_t vertices) { return vertices * (2 * sizeof(Vec3) + 4 * sizeof(uint32_t)); }

private:
    const SceneView& scene_;
    std::vector<uint64_t> first_; // [instances] first vertex in at_
    std::vector<Vec3> at_;
};

} // namespace pertev
