#pragma once

// What moves the vertices of a mesh beside the place where it stands: morph targets, the joints of a skin, and the
// vertices before any of them. Scene::meshes has what comes out (scene/shape_mesh.h), at rest or at a time.
//
// Source: glTF 2.0 sections 3.7.2.2 and 3.7.3.

#include <cstdint>
#include <vector>

#include "math/vec3.h"
#include "math/vec4.h"
#include "scene/node.h"

namespace pertev {

/// What is added to the vertices, times the target's weight: [vertices] each, or empty.
struct MorphTarget {
    std::vector<Vec3> positions, normals, tangents;
};

struct MeshShape {
    uint32_t mesh = 0;       // index into Scene::meshes
    uint32_t node = kNoNode; // index into Scene::nodes: whose morph_weights count; of targets alone
    uint32_t skin = kNoSkin; // index into Scene::skins

    // [vertices], or empty as those of the mesh: before targets and skin.
    std::vector<Vec3> positions; // metres
    std::vector<Vec3> normals;   // of any length but 0
    std::vector<Vec4> tangents;  // xyz of any length but 0, w = +-1
    std::vector<MorphTarget> targets;

    uint32_t joints_per_vertex = 0; // of a skin; 0: no vertex is moved by it
    std::vector<uint32_t> joints;   // [vertices * joints_per_vertex], indices into the skin's joints
    std::vector<float> weights;     // as many; of any sum, and a vertex without weight stays
    bool is_turned_over = false;    // the mesh's triangles wind the other way now than in the file (shape_mesh)
};

/// What the vertices of a shape's mesh are made with at a time.
struct MeshPose {
    std::vector<float> morph_weights; // by target; those past the end are 0
    std::vector<Transform> joints;    // world from mesh space, with the inverse bind matrices; empty without a skin
    bool is_on_host = true; // Scene::meshes has these vertices; else those of rest, and whoever renders makes these
};

/// Whether both have the same numbers, to the bit, and the same place.
bool same_pose(const MeshPose& a, const MeshPose& b);

} // namespace pertev
