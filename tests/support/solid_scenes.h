#pragma once

// Closed solids of glass under a sky.

#include "tests/support/flat_scenes.h"
#include "tests/support/meshes.h"
#include "tests/support/render_scenes.h"

namespace pertev::test {

/// A closed box of twelve triangles about `centre`, fronts outwards.
inline Mesh box(Vec3 centre, Vec3 half) {
    Mesh mesh;
    for (const float z : {-1.0f, 1.0f})
        for (const float y : {-1.0f, 1.0f})
            for (const float x : {-1.0f, 1.0f}) {
                mesh.positions.push_back(centre + Vec3{x * half.x, y * half.y, z * half.z});
            }
    mesh.indices = {0, 2, 3, 0, 3, 1, 4, 5, 7, 4, 7, 6, 0, 1, 5, 0, 5, 4,
                    2, 6, 7, 2, 7, 3, 0, 4, 6, 0, 6, 2, 1, 3, 7, 1, 7, 5};
    return mesh;
}
inline Mesh ball(Vec3 centre, float radius) {
    const TriangleMesh sphere = make_sphere(3, centre, radius);
    Mesh mesh;
    mesh.positions = sphere.positions;
    mesh.indices = sphere.indices;
    return mesh;
}

inline Material glass(float ior) {
    return {{.kind = MaterialKind::Dielectric, .base_color = {1, 1, 1}, .roughness = 0, .ior = ior}, "glass"};
}

/// An empty scene under a sky of radiance 1.
inline Scene under_sky() {
    Scene scene;
    scene.environment = Environment{};
    return scene;
}

} // namespace pertev::test
