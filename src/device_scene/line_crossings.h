#pragma once

// Where lines along a fixed direction meet a mesh: a grid of its triangles across the direction, so that a line tests
// only those of one cell.

#include <cstdint>
#include <span>
#include <vector>

#include "math/double_vec3.h"
#include "math/vec3.h"

namespace pertev {

class LineCrossings {
public:
    /// Sorts the triangles, three `indices` each into `positions`, into a grid across `along`.
    LineCrossings(std::span<const Vec3> positions, std::span<const uint32_t> indices, DoubleVec3 along);

    /// Returns how many triangles of one orientation the half line from a point meets, less those of the other. The
    /// mesh is that of the constructor.
    int count(std::span<const Vec3> positions, std::span<const uint32_t> indices, DoubleVec3 from) const;

private:
    struct GridPoint {
        double x, y; // in cells
    };
    GridPoint grid_point_of(DoubleVec3 point) const;
    uint32_t cell(double at) const; // along a side

    DoubleVec3 along_, x_axis_, y_axis_; // the axes measure in cells
    DoubleVec3 corner_ = {0, 0, 0};      // a point of the first cell's corner
    uint32_t side_ = 1;                  // cells
    std::vector<uint32_t> starts_;       // [side^2 + 1] of triangles_
    std::vector<uint32_t> triangles_;    // by cells
};

} // namespace pertev
