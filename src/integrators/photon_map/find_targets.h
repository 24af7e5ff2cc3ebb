#pragma once

// Finds the spheres that photons of the caustic map are aimed at, from the triangles of a scene as it stands on the
// device: the bounds of all surfaces that may mirror or refract, then those of what lies in each of 4 x 4 x 4 cells of
// them. One sphere round all, or those of some cells: the smallest together serve best.

#include <vector>

#include "accel/hploc/leaves.h"
#include "integrators/photon_map/photon_targets.h"
#include "shading/may_be_specular.h"

namespace pertev {

inline constexpr uint32_t kTargetCellsAcross = 4;
static_assert(kTargetCellsAcross * kTargetCellsAcross * kTargetCellsAcross <= kMostTargets);

/// What the stages find. Of nothing all bytes are hploc::kNothing.
struct SpecularBounds {
    hploc::OrderedBounds all, cells[kMostTargets];
    int32_t reach; // hploc::ordered of minus the squared distance, of the farthest corner from the middle of `all`
};

/// Triangle i of all instances: extends the bounds, or, once these are known, those of the cells.
struct FindSpecular {
    SceneView scene;
    SpecularBounds* bounds;
    bool in_cells;

    HD void operator()(uint32_t i) const {
        uint32_t low = 0, high = scene.instance_count; // first_triangle[low] <= i < first_triangle[high]
        while (high - low > 1) {
            const uint32_t middle = low + (high - low) / 2;
            (scene.first_triangle[middle] <= i ? low : high) = middle;
        }
        const InstanceView& instance = scene.instances[low];
        if (instance.is_hidden != 0 || !may_be_specular(scene.materials[instance.material])) return;
        const MeshView& mesh = scene.meshes[instance.mesh];
        const TriangleIndices corners = triangle_indices(mesh, i - scene.first_triangle[low]);
        const auto place = [&](uint32_t corner) {
            return transform_point(instance.world_from_local, mesh.positions[corner]);
        };
        const Vec3 at[3] = {place(corners.a), place(corners.b), place(corners.c)};
        Bounds3 box;
        for (const Vec3 corner : at) box.extend(corner);
        if (!in_cells) return extend(bounds->all, box);
        const Vec3 middle = 0.5f * (bounds->all.lo() + bounds->all.hi());
        for (const Vec3 corner : at) hploc::lower(&bounds->reach, hploc::ordered(-length_squared(corner - middle)));
        const Vec3 lo = bounds->all.lo(), size = bounds->all.hi() - lo;
        int first[3], last[3];
        for (int k = 0; k < 3; ++k) {
            first[k] = cell_of(component(box.lo, k), component(lo, k), component(size, k));
            last[k] = cell_of(component(box.hi, k), component(lo, k), component(size, k));
        }
        const Vec3 cell = (1.0f / kTargetCellsAcross) * size;
        for (int z = first[2]; z <= last[2]; ++z) {
            for (int y = first[1]; y <= last[1]; ++y) {
                for (int x = first[0]; x <= last[0]; ++x) {
                    const auto of = [](int n) { return static_cast<float>(n); };
                    const Vec3 from = lo + Vec3{of(x) * cell.x, of(y) * cell.y, of(z) * cell.z};
                    const Vec3 to = lo + Vec3{of(x + 1) * cell.x, of(y + 1) * cell.y, of(z + 1) * cell.z};
                    const uint32_t number = static_cast<uint32_t>((z * 4 + y) * 4 + x);
                    extend(bounds->cells[number], {max(box.lo, from), min(box.hi, to)});
                }
            }
        }
    }

private:
    HD static int cell_of(float x, float lo, float size) {
        return to_int((x - lo) / size * static_cast<float>(kTargetCellsAcross), 0, int(kTargetCellsAcross) - 1);
    }
    HD static void extend(hploc::OrderedBounds& target, const Bounds3& box) {
        const float values[6] = {box.lo.x, box.lo.y, box.lo.z, -box.hi.x, -box.hi.y, -box.hi.z};
        for (int k = 0; k < 6; ++k) hploc::lower(target.least + k, hploc::ordered(values[k]));
    }
};

/// The spheres; none where nothing was found.
std::vector<Float4> choose_targets(const SpecularBounds& found);

} // namespace pertev
