#pragma once

// Refits an eight-wide tree to a mesh whose vertices have moved. Its topology does not change.

#include <cstdint>

#include "accel/bvh/wide_bvh.h"
#include "device_scene/deformed_mesh.h"
#include "tracer/hploc/refit_upwards.h"

namespace pertev {

/// Writes triangle `primitive` of the mesh in the form that builders read.
HD inline void take_corners(const DeformedMesh& mesh, BvhTriangle& triangle) {
    const uint32_t* v = mesh.indices + 3 * static_cast<uint64_t>(triangle.primitive);
    triangle.a = mesh.positions[v[0]];
    triangle.b = mesh.positions[v[1]];
    triangle.c = mesh.positions[v[2]];
}

/// The stage that lists the triangles of a mesh, in its order.
struct ListTriangles {
    DeformedMesh mesh;
    BvhTriangle* triangles;

    HD void operator()(uint32_t i) const {
        BvhTriangle triangle;
        triangle.primitive = i;
        take_corners(mesh, triangle);
        triangles[i] = triangle;
    }
};

/// The stage that counts the inner children of each node and stores their links to it.
struct LinkWideParents {
    const WideBvhNode<8>* nodes;
    uint32_t *parents, *children;

    HD void operator()(uint32_t i) const {
        uint32_t count = 0;
        for (int k = 0; k < 8; ++k) {
            const uint32_t child = nodes[i].child[k];
            if (child == kNoLink || (child & kLeafBit) != 0) continue;
            parents[child] = i;
            ++count;
        }
        children[i] = count;
    }
};

/// The stage that refits the boxes, with one call per node.
struct RefitWide {
    DeformedMesh mesh;
    WideBvhNode<8>* nodes;
    BvhTriangle* triangles;
    UpwardLinks links;
    CollapseSettings costs;

    HD void operator()(uint32_t i) const {
        links.climb_from(i, [this](uint32_t node) { return fit(node); });
    }

private:
    HD NodeBox fit(uint32_t i) const {
        WideBvhNode<8>& node = nodes[i];
        Bounds3 all;
        float cost = 0;
        for (int k = 0; k < 8 && node.child[k] != kNoLink; ++k) {
            Bounds3 box;
            if ((node.child[k] & kLeafBit) != 0) {
                const uint32_t first = node.child[k] & ~kLeafBit;
                for (uint32_t t = first; t < first + node.count[k]; ++t) {
                    take_corners(mesh, triangles[t]);
                    box.extend(triangles[t].a);
                    box.extend(triangles[t].b);
                    box.extend(triangles[t].c);
                }
                const auto at_once = static_cast<uint32_t>(costs.triangles_at_once);
                const uint32_t steps = (node.count[k] + at_once - 1) / at_once;
                cost += box.half_area() * (costs.triangle_cost * static_cast<float>(steps));
            } else {
                const NodeBox child = links.box_of(node.child[k]);
                box = {child.lo, child.hi};
                cost += child.cost;
            }
            const float planes[6] = {box.lo.x, box.hi.x, box.lo.y, box.hi.y, box.lo.z, box.hi.z};
            for (int p = 0; p < 6; ++p) node.planes[p][k] = planes[p];
            all.extend(box);
        }
        return {all.lo, cost + all.half_area() * costs.node_cost, all.hi, 0};
    }
};

} // namespace pertev
