#pragma once

// Embree 3 or 4 for comparison of hits and speed: one mesh, traced by its robust single-ray functions.

#if PERTEV_EMBREE == 4
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

#include "tests/support/meshes.h"
#include "trace/intersect/ray.h"

namespace pertev::test {

class EmbreeScene {
public:
    explicit EmbreeScene(const TriangleMesh& mesh);
    ~EmbreeScene();
    EmbreeScene(const EmbreeScene&) = delete;
    EmbreeScene& operator=(const EmbreeScene&) = delete;

    /// The primitive is an index into the mesh's triangles; the instance is 0.
    Hit closest(const Ray& ray) const;
    bool any(const Ray& ray) const;

private:
    RTCDevice device_;
    RTCScene scene_;
};

} // namespace pertev::test
