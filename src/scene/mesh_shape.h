#pragma once

// Deformation data of a mesh: morph targets, joints of a skin, and the undeformed vertices. Scene::meshes holds the
// deformed vertices (scene/shape_mesh.h), at rest or at a time.
//
// Source: glTF 2.0 sections 3.7.2.2 and 3.7.3.

#include <cstdint>
#include <vector>

#include "math/vec3.h"
#include "math/vec4.h"
#include "scene/node.h"

namespace pertev {

/// Offsets added to the vertices, multiplied by the target's weight: [vertices] each, or empty.
struct MorphTarget {
    std::vector<Vec3> positions, normals, tangents;
};

struct MeshShape {
    uint32_t mesh = 0;       // index into Scene::meshes
    uint32_t node = kNoNode; // index into Scene::nodes: the node whose morph_weights apply; used only with targets
    uint32_t skin = kNoSkin; // index into Scene::skins

    // [vertices], or empty if the mesh has none: before targets and skin.
    std::vector<Vec3> positions; // metres
    std::vector<Vec3> normals;   // any length but 0
    std::vector<Vec4> tangents;  // xyz with any length but 0, w = +-1
    std::vector<MorphTarget> targets;

    uint32_t joints_per_vertex = 0; // joints per vertex of a skin; 0: no vertex has joints
    std::vector<uint32_t> joints;   // [vertices * joints_per_vertex], indices into the skin's joints
    std::vector<float> weights;     // a weight for each of `joints`; any sum, and a vertex without weight is not moved
    bool is_turned_over = false;    // the mesh's triangles have the opposite winding of the file's (shape_mesh)
};

/// Inputs of the deformation of a shape's mesh at a time.
struct MeshPose {
    std::vector<float> morph_weights; // by target; those past the end are 0
    std::vector<Transform> joints;    // world from mesh space, with the inverse bind matrices; empty without a skin
    bool is_on_host = true; // Scene::meshes has the deformed vertices; otherwise it has those at rest, and the
                            // renderer deforms them
};

/// Returns whether two poses are equal to the bit, including the flag.
bool same_pose(const MeshPose& a, const MeshPose& b);

} // namespace pertev
