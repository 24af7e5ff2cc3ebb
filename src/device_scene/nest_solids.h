#pragma once

// Finds the solids of glass or water that lie in each other, and ranks them. A solid is an instance of a closed mesh
// whose material light enters; it counts here if its box overlaps that of another one. Where several hold a point, the
// one of the greatest priority fills it, of equal ones that in the most others, then one that is no clear boundary,
// then the first of the scene. In a scene with media every solid counts, and so does an open mesh with a medium, which
// then begins where a ray crosses it and holds no camera.

#include <cstdint>
#include <map>
#include <memory>
#include <vector>

#include "device_scene/interior_list.h"
#include "device_scene/line_crossings.h"
#include "math/bounds3.h"
#include "scene/scene.h"

namespace pertev {

/// The closed meshes of a scene. Each is found and copied once, until clear(), which must follow a change of meshes.
class ClosedMeshes {
public:
    struct Shape {
        std::vector<Vec3> positions;
        std::vector<uint32_t> indices;
        std::vector<LineCrossings> lines; // in three directions
    };
    /// Returns the scene's mesh of this number, or null if it is open.
    std::shared_ptr<const Shape> shape_of(const Scene& scene, uint32_t mesh);
    void clear() { found_.clear(); }

private:
    std::map<uint32_t, std::shared_ptr<const Shape>> found_;
};

class NestedSolids {
public:
    NestedSolids() = default;
    /// Meshes whose vertices move have those at rest. `centre` is the origin of the translated world. `closed` may have
    /// meshes of the scene from before.
    NestedSolids(const Scene& scene, Vec3 centre, ClosedMeshes& closed);
    NestedSolids(const Scene& scene, Vec3 centre);

    bool is_empty() const { return ranks_.empty(); }
    /// [instance] its rank; 0: none. Empty without nested solids.
    const std::vector<uint16_t>& ranks() const { return ranks_; }
    /// [rank] its instance; the first is none.
    const std::vector<uint32_t>& instances() const { return instances_; }
    /// Returns whether any of some corners of each solid is inside another one, not only in its box. Clear boundaries
    /// do not count.
    bool is_nested() const;
    /// Returns the solids that hold a point of the translated world.
    InteriorList at(Vec3 point) const;

private:
    struct Solid {
        uint32_t instance = 0;
        std::shared_ptr<const ClosedMeshes::Shape> shape; // null: the mesh is open
        Transform world_from_local, local_from_world;     // the scene's coordinates
        Bounds3 bounds;
        float priority = 0;
        bool is_clear = false; // a clear boundary, which has no interface
        uint32_t depth = 0;    // solids that hold it
    };
    bool holds(const Solid& solid, Vec3 point) const;
    bool holds(const Solid& outer, const Solid& inner, const Mesh& mesh) const;

    std::vector<uint16_t> ranks_;
    std::vector<uint32_t> instances_;
    std::vector<Solid> solids_; // [rank - 1]
    Vec3 centre_;
};

/// Returns the box of the mesh's triangles.
Bounds3 world_bounds(const Mesh& mesh, const Transform& world_from_local);
/// Returns whether each edge of the mesh has two triangles of opposite direction, of corners at equal positions.
bool is_closed(const Mesh& mesh);

} // namespace pertev
