#pragma once

// Finds the corners of patches that are at the same position on one surface. A position is the corner's own, rounded
// to floats: patches of triangles that share an edge divide it by the same numbers, so no tolerance is needed (except
// for vertices: radiosity/welded_vertices.h). Corners there with similar normals form a sheet. The number of sheets
// at a position is limited by the number of distinct directions, so time grows linearly with patches.

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "radiosity/patches.h"
#include "radiosity/welded_vertices.h"

namespace pertev {

struct CornerSheet {
    Vec3 position;        // metres
    Vec3 normal;          // unit
    double areas = 0;     // total area of its patches, m2
    double light[3] = {}; // irradiance by area, W
    Rgb shown;            // displayed irradiance of all its corners, W/m2
};

class CornerTable {
public:
    /// Finds the corners of all patches. `scene` and `tree` outlive it.
    CornerTable(const SceneView& scene, const PatchTree& tree, std::span<const Rgb> irradiance);

    /// Sheet of corner `number` of a patch.
    CornerSheet& sheet_of(uint32_t patch, uint32_t number) { return sheets_[sheet_of_[3 * uint64_t(patch) + number]]; }
    const CornerSheet& sheet_of(uint32_t patch, uint32_t number) const {
        return sheets_[sheet_of_[3 * uint64_t(patch) + number]];
    }
    /// All sheets at a position, in a fixed order.
    std::span<CornerSheet> at(Vec3 position);
    /// Position with these weights of the second and third corner of a patch's triangle.
    Vec3 position_of(uint32_t patch, double u, double v) const;
    Vec3 normal_of(uint32_t patch) const { return normals_[patch]; }

    /// Calls body(sheets) for the sheets of each position, from any thread.
    void for_each_position(const std::function<void(std::span<CornerSheet>)>& body);

    /// Maximum bytes for a number of patches.
    static std::size_t max_bytes(uint64_t patches);

private:
    struct Corner {
        Vec3 position;
        uint32_t direction, id; // direction of its normal; 3 patch + number
    };
    std::size_t buckets() const { return first_sheet_.size() - 1; }
    std::size_t bucket_of(Vec3 position) const;
    std::vector<Corner> corners_by_bucket();
    std::vector<CornerSheet> sheets_of(std::span<const Corner> corners, std::span<const Rgb> irradiance);

    const PatchTree& tree_;
    WeldedVertices vertices_;
    std::vector<Vec3> normals_;                        // [patches]
    std::vector<uint32_t> sheet_of_;                   // [3 patches]
    std::vector<uint32_t> first_corner_, first_sheet_; // [buckets + 1]
    std::vector<CornerSheet> sheets_;                  // by bucket, by position
};

/// Returns whether two patches or sheets with these normals share one light where they meet: within 30 degrees.
inline bool is_same_surface(Vec3 a, Vec3 b) { return dot(a, b) > 0.866f; }

} // namespace pertev
