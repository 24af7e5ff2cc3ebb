#include "accel/builders/find_spatial_cut.h"

#include "accel/bvh/binned_cut.h"
#include "base/parallel_for.h"

namespace pertev {
namespace {

constexpr int kMinPlanes = 8, kMaxPlanes = 32;

bool has_points(const Box4& b) { return (_mm_movemask_ps(_mm_cmple_ps(b.lo, b.hi)) & 7) == 7; }

__m128 load(Vec3 p) { return _mm_setr_ps(p.x, p.y, p.z, 0); }

/// Bins along one axis. There are no planes if there is no room for them.
struct Row {
    int axis = 0, bins = 0;
    float lo = 0, scale = 0;
    float planes[kMaxPlanes + 1];

    Row(const Bounds3& box, int along, int count) : axis(along), lo(component(box.lo, along)) {
        const float hi = component(box.hi, axis);
        for (int k = 0; k <= count; ++k) {
            const float part = static_cast<float>(k) / static_cast<float>(count);
            planes[k] = k < count ? lo + part * (hi - lo) : hi;
            if (k > 0 && !(planes[k - 1] < planes[k])) return;
        }
        scale = static_cast<float>(count) / (hi - lo);
        if (is_finite(scale)) bins = count;
    }
    int bin_of(float at, int first, int last) const { return to_int((at - lo) * scale, first, last); }
};

/// Boxes of bins, of which only those of a row are cleared.
class RowBoxes {
public:
    explicit RowBoxes(int bins) {
        for (int k = 0; k < bins; ++k) clear(k);
    }
    void clear(int k) { lo_[k] = Box4{}.lo, hi_[k] = Box4{}.hi; }
    void extend(int k, const Box4& box) { lo_[k] = _mm_min_ps(lo_[k], box.lo), hi_[k] = _mm_max_ps(hi_[k], box.hi); }
    void extend_point(int k, __m128 p) { extend(k, {p, p}); }
    Box4 operator[](int k) const { return {lo_[k], hi_[k]}; }

private:
    __m128 lo_[kMaxPlanes], hi_[kMaxPlanes];
};

struct RowBins {
    RowBoxes box;
    uint32_t begins[kMaxPlanes] = {}, ends[kMaxPlanes] = {}; // references whose first and whose last part lies here

    explicit RowBins(int bins) : box(bins) {}
};

/// Adds the boxes of a triangle's parts in bins [first, last], each at most as large as the reference's. `parts` are
/// empty boxes, which are empty again afterwards: most triangles need few of them.
void add_parts(const Row& row, const Box4& whole, float lo, float hi, const BvhTriangle& triangle, int first, int last,
               RowBoxes& parts, RowBins& bins) {
    const __m128 corners[3] = {load(triangle.a), load(triangle.b), load(triangle.c)};
    const float at[3] = {component(triangle.a, row.axis), component(triangle.b, row.axis),
                         component(triangle.c, row.axis)};
    for (int k = 0; k < 3; ++k) {
        if (at[k] >= lo && at[k] <= hi) parts.extend_point(row.bin_of(at[k], first, last), corners[k]);
        const int next = k == 2 ? 0 : k + 1;
        const float from = min(at[k], at[next]), to = max(at[k], at[next]);
        if (!(from < to)) continue;
        const __m128 along = _mm_sub_ps(corners[next], corners[k]);
        const float per_unit = 1 / (at[next] - at[k]);
        const auto crossing = [&](float plane) {
            return _mm_add_ps(corners[k], _mm_mul_ps(along, _mm_set1_ps((plane - at[k]) * per_unit)));
        };
        if (from < lo && lo < to) parts.extend_point(first, crossing(lo));
        if (from < hi && hi < to) parts.extend_point(last, crossing(hi));
        const int begin = row.bin_of(from, first, last), end = row.bin_of(to, first, last);
        for (int plane = begin + 1; plane <= end; ++plane) {
            const __m128 point = crossing(row.planes[plane]);
            parts.extend_point(plane - 1, point);
            parts.extend_point(plane, point);
        }
    }
    for (int k = first; k <= last; ++k) {
        const Box4 part = {_mm_max_ps(parts[k].lo, whole.lo), _mm_min_ps(parts[k].hi, whole.hi)};
        if (has_points(part)) bins.box.extend(k, part);
        parts.clear(k);
    }
}

void fill_row(std::span<const BuildReference> references, const std::vector<BvhTriangle>& triangles, const Row& row,
              RowBins& bins) {
    RowBoxes parts(row.bins);
    for (const BuildReference& r : references) {
        const float lo = component(r.lo, row.axis), hi = component(r.hi, row.axis);
        const int first = row.bin_of(lo, 0, row.bins - 1), last = row.bin_of(hi, first, row.bins - 1);
        ++bins.begins[first];
        ++bins.ends[last];
        const Box4 whole = simd_box_of(r);
        if (first == last) {
            bins.box.extend(first, whole);
        } else {
            add_parts(row, whole, lo, hi, triangles[r.id], first, last, parts, bins);
        }
    }
}

/// Replaces `best` if a plane of the row is cheaper.
void find_plane(const Row& row, const RowBins& bins, uint64_t count, uint64_t allowance, SpatialCut& best) {
    RowBoxes right(row.bins); // the boxes of the bins from this one on
    Box4 sum;
    for (int k = row.bins - 1; k > 0; --k) {
        sum.extend(bins.box[k]);
        right.extend(k, sum);
    }
    Box4 left;
    uint64_t left_size = 0, right_size = count;
    for (int k = 1; k < row.bins; ++k) {
        left.extend(bins.box[k - 1]);
        left_size += bins.begins[k - 1];
        right_size -= bins.ends[k - 1];
        if (left_size == 0 || right_size == 0 || left_size + right_size - count > allowance) continue;
        if (!has_points(left) || !has_points(right[k])) continue;
        const float cost =
            half_area(left) * static_cast<float>(left_size) + half_area(right[k]) * static_cast<float>(right_size);
        if (!(cost < best.cost)) continue;
        best = {cost, row.axis, row.planes[k], to_bounds(left), to_bounds(right[k]), left_size, right_size};
    }
}

} // namespace

SpatialCut find_spatial_cut(std::span<const std::span<const BuildReference>> chunks,
                            const std::vector<BvhTriangle>& triangles, const Bounds3& box, uint64_t allowance) {
    uint64_t count = 0;
    for (const auto& chunk : chunks) count += chunk.size();
    // The number of planes is the number of references, because in small nodes, which are most, a triangle reaches
    // through most bins.
    const int planes = to_int(static_cast<float>(count), kMinPlanes, kMaxPlanes);
    SpatialCut best;
    for (int axis = 0; axis < 3; ++axis) {
        const Row row(box, axis, planes);
        if (row.bins == 0) continue;
        RowBins bins(row.bins);
        if (chunks.size() == 1) {
            fill_row(chunks[0], triangles, row, bins);
        } else {
            std::vector<RowBins> parts;
            parts.reserve(chunks.size());
            for (std::size_t i = 0; i < chunks.size(); ++i) parts.emplace_back(row.bins);
            parallel_for(chunks.size(), 1, [&](uint64_t i) { fill_row(chunks[i], triangles, row, parts[i]); });
            for (const RowBins& part : parts) {
                for (int k = 0; k < row.bins; ++k) {
                    bins.box.extend(k, part.box[k]);
                    bins.begins[k] += part.begins[k];
                    bins.ends[k] += part.ends[k];
                }
            }
        }
        find_plane(row, bins, count, allowance, best);
    }
    return best;
}

} // namespace pertev
