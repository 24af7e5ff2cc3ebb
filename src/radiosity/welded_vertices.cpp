#include "radiosity/welded_vertices.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "base/parallel_for.h"
#include "math/random.h"

namespace pertev {
namespace {

constexpr uint32_t kNone = 0xffffffffu;
constexpr int kCellLevel = 20; // a cell's side is 2^-20 of the power of two below the largest coordinate
constexpr int kMinLevel = -100;

int level_of(float largest) { return largest > 0 ? std::max(std::ilogb(largest), kMinLevel) : kMinLevel; }

struct Cell {
    int32_t x, y, z;
    int level;
};

int32_t cell_of(double coordinate, int level) {
    return static_cast<int32_t>(std::floor(std::ldexp(coordinate, kCellLevel - level)));
}

/// Distinct positions, found by the cells of a grid that is as fine as their coordinates.
class WeldedPositions {
public:
    explicit WeldedPositions(std::size_t most) : heads_(std::bit_ceil(most + 1), kNone) {}

    /// Returns the first position that is equal to `here` up to kWeld; otherwise `here`, which is added.
    Vec3 find_or_keep(Vec3 here) {
        const float largest = max_component(abs(here));
        const float near = WeldedVertices::kWeld * largest;
        uint32_t best = kNone;
        const int low = level_of(largest - near), high = level_of(largest + near);
        for (int level = low; level <= high; ++level) {
            const Cell from = corner(here, -near, level), to = corner(here, near, level);
            for (int32_t z = from.z; z <= to.z; ++z) {
                for (int32_t y = from.y; y <= to.y; ++y) {
                    for (int32_t x = from.x; x <= to.x; ++x) best = std::min(best, find({x, y, z, level}, here, near));
                }
            }
        }
        if (best != kNone) return positions_[best];
        const std::size_t slot = slot_of(corner(here, 0, level_of(largest)));
        next_.push_back(heads_[slot]);
        heads_[slot] = static_cast<uint32_t>(positions_.size());
        positions_.push_back(here);
        return here;
    }

private:
    static Cell corner(Vec3 p, float by, int level) {
        const auto off = static_cast<double>(by);
        return {cell_of(static_cast<double>(p.x) + off, level), cell_of(static_cast<double>(p.y) + off, level),
                cell_of(static_cast<double>(p.z) + off, level), level};
    }
    std::size_t slot_of(Cell cell) const {
        const Hash4 bits = hash_words(static_cast<uint32_t>(cell.x), static_cast<uint32_t>(cell.y),
                                      static_cast<uint32_t>(cell.z), static_cast<uint32_t>(cell.level));
        return (uint64_t(bits.x) << 32 | bits.y) & (heads_.size() - 1);
    }
    uint32_t find(Cell cell, Vec3 here, float near) const {
        uint32_t best = kNone;
        for (uint32_t i = heads_[slot_of(cell)]; i != kNone; i = next_[i]) {
            if (max_component(abs(positions_[i] - here)) <= near) best = std::min(best, i);
        }
        return best;
    }

    std::vector<uint32_t> heads_, next_;
    std::vector<Vec3> positions_;
};

} // namespace

WeldedVertices::WeldedVertices(const SceneView& scene) : scene_(scene) {
    first_.reserve(scene.instance_count);
    uint64_t count = 0;
    for (uint32_t instance = 0; instance < scene.instance_count; ++instance) {
        first_.push_back(count);
        const InstanceView& placed = scene.instances[instance];
        if (placed.is_hidden != 0) continue;
        const uint64_t indices = 3 * uint64_t(scene.first_triangle[instance + 1] - scene.first_triangle[instance]);
        if (indices == 0) continue;
        const uint32_t* all = scene.meshes[placed.mesh].indices;
        count += uint64_t(*std::max_element(all, all + indices)) + 1;
    }
    at_.resize(count);
    WeldedPositions welded(count);
    for (uint32_t instance = 0; instance < scene.instance_count; ++instance) {
        const uint64_t end = instance + 1 < scene.instance_count ? first_[instance + 1] : count;
        const InstanceView& placed = scene.instances[instance];
        for (uint64_t i = first_[instance]; i < end; ++i) {
            const Vec3 local = scene.meshes[placed.mesh].positions[i - first_[instance]];
            at_[i] = welded.find_or_keep(transform_point(placed.world_from_local, local));
        }
    }
}

void WeldedVertices::corners(uint32_t instance, uint32_t primitive, Vec3 (&at)[3]) const {
    const TriangleIndices i = triangle_indices(scene_.meshes[scene_.instances[instance].mesh], primitive);
    const Vec3* first = at_.data() + first_[instance];
    at[0] = first[i.a], at[1] = first[i.b], at[2] = first[i.c];
}

} // namespace pertev
