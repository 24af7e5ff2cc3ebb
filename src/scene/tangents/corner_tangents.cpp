#include "scene/tangents/corner_tangents.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "base/parallel_for.h"
#include "math/double_pi.h"
#include "math/scalar.h"

namespace pertev {
namespace {

constexpr uint64_t kTangentGrain = 1 << 10;
constexpr Vec4 kNoDirection = {1, 0, 0, 1};

/// Projects `v` into the plane across the unit normal `n` and scales it to length 1; zero stays zero.
Vec3 lay_across(Vec3 n, Vec3 v) {
    const Vec3 across = v - dot(n, v) * n;
    const bool is_something = is_not_zero(across.x) || is_not_zero(across.y) || is_not_zero(across.z);
    return is_something ? normalize(across) : across;
}

/// The series asin(y) = y + y^3 (1/2)/3 + y^5 (1 3)/(2 4)/5 + ...: for |y| <= 1/2 these terms are good to 2^-50.
constexpr std::array<double, 24> kArcsine = [] {
    std::array<double, 24> terms = {};
    double product = 1;
    for (std::size_t k = 0; k < terms.size(); ++k) {
        const double n = 2 * static_cast<double>(k);
        terms[k] = product / (n + 1);
        product *= (n + 1) / (n + 2);
    }
    return terms;
}();

double arcsine(double y) {
    double sum = 0;
    for (std::size_t k = kArcsine.size(); k-- > 0;) sum = sum * (y * y) + kArcsine[k];
    return y * sum;
}

/// Returns the arc cosine of `x` in [-1, 1], rounded to the nearest float. The one of math/portable_math.h may be 2 ulp
/// off. That shows where the directions round a vertex cancel, because their sum then depends on the angles' last bits.
float angle_of_cosine(float x) {
    const double size = static_cast<double>(abs(x));
    if (size <= 0.5) return static_cast<float>(kPiDouble / 2 - arcsine(static_cast<double>(x)));
    const double angle = 2 * arcsine(std::sqrt((1 - size) / 2));
    return static_cast<float>(x > 0 ? angle : kPiDouble - angle);
}

/// One triangle's contribution to the mean at one of its corners.
struct Share {
    Vec3 along_u, along_v; // perpendicular to the normal, unit or zero
    float angle;           // radians, between the triangle's edges after projection along the normal
    bool is_known;         // otherwise it contributes nothing
};

Share share_of(const TangentMesh& mesh, const UvDirections& directions, uint32_t corner) {
    const Vec3 n = mesh.normal(corner), at = mesh.position(corner);
    const Vec3 before = lay_across(n, mesh.position(previous_corner(corner)) - at);
    const Vec3 after = lay_across(n, mesh.position(next_corner(corner)) - at);
    return {.along_u = lay_across(n, directions.along_u),
            .along_v = lay_across(n, directions.along_v),
            .angle = angle_of_cosine(clamp(dot(before, after), -1.0f, 1.0f)),
            .is_known = directions.is_known};
}

/// Returns whether two triangles of one group take part in each other's tangent, that is, unless their directions of u
/// or of v are opposite. (The method has a threshold angle for this; everyone uses its default, a half turn.)
bool go_together(const Share& a, const Share& b) {
    return !a.is_known || !b.is_known || (dot(a.along_u, b.along_u) > -1 && dot(a.along_v, b.along_v) > -1);
}

/// Returns true if all directions lie within a quarter turn of their mean, so that no two are opposite.
bool all_go_together(std::span<const Share> shares) {
    Vec3 sum_u, sum_v;
    for (const Share& share : shares) {
        sum_u += share.along_u;
        sum_v += share.along_v;
    }
    const Vec3 mean_u = normalize(sum_u), mean_v = normalize(sum_v);
    return std::ranges::all_of(shares, [&](const Share& share) {
        return !share.is_known || (dot(mean_u, share.along_u) > 0.01f && dot(mean_v, share.along_v) > 0.01f);
    });
}

template <class Takes>
Vec3 weighted_mean(std::span<const Share> shares, const Takes& takes) {
    Vec3 sum;
    for (std::size_t i = 0; i < shares.size(); ++i) {
        if (shares[i].is_known && takes(i)) sum += shares[i].angle * shares[i].along_u;
    }
    return sum;
}

class GroupTangents {
public:
    explicit GroupTangents(std::vector<Vec4>& tangents) : tangents_(tangents) {}

    void set(std::span<const uint32_t> corners, std::span<const Share> shares, float handedness) {
        if (corners.size() > kMaxCompared || all_go_together(shares)) {
            const Vec4 tangent = unit_tangent(weighted_mean(shares, [](std::size_t) { return true; }), handedness);
            for (const uint32_t corner : corners) tangents_[corner] = tangent;
            return;
        }
        by_members_.clear();
        for (std::size_t i = 0; i < corners.size(); ++i) {
            Members members = {};
            for (std::size_t k = 0; k < corners.size(); ++k) {
                if (i == k || go_together(shares[i], shares[k])) members[k / 64] |= uint64_t(1) << (k % 64);
            }
            const auto [entry, is_new] = by_members_.try_emplace(members);
            if (is_new) {
                const auto takes = [&](std::size_t k) { return (members[k / 64] >> (k % 64) & 1) != 0; };
                entry->second = unit_tangent(weighted_mean(shares, takes), handedness);
            }
            tangents_[corners[i]] = entry->second;
        }
    }

private:
    /// Maximum number of triangles in a group that is compared pair by pair; in a larger group all take part.
    static constexpr std::size_t kMaxCompared = 256;
    using Members = std::array<uint64_t, kMaxCompared / 64>; // a bit for each

    static Vec4 unit_tangent(Vec3 sum, float handedness) {
        const Vec3 tangent = normalize(sum);
        if (!is_finite(tangent)) return {kNoDirection.x, kNoDirection.y, kNoDirection.z, handedness};
        return {tangent.x, tangent.y, tangent.z, handedness};
    }

    std::vector<Vec4>& tangents_;
    std::map<Members, Vec4> by_members_;
};

} // namespace

std::vector<Vec4> corner_tangents(const TangentMesh& mesh, const TangentGroups& groups) {
    std::vector<UvDirections> directions(mesh.corner_count() / 3);
    parallel_for(directions.size(), kTangentGrain, [&](uint64_t i) { directions[i] = uv_directions(mesh, i); });
    std::vector<Vec4> tangents(mesh.corner_count(), kNoDirection);
    parallel_for_ranges(groups.count(), kTangentGrain, [&](uint64_t begin, uint64_t end) {
        GroupTangents group(tangents);
        std::vector<Share> shares;
        for (uint64_t i = begin; i < end; ++i) {
            const std::span<const uint32_t> corners = groups.corners_of(i);
            shares.clear();
            for (const uint32_t corner : corners) shares.push_back(share_of(mesh, directions[corner / 3], corner));
            group.set(corners, shares, groups.is_counter_clockwise[i] != 0 ? -1.0f : 1.0f);
        }
    });
    for (const BorrowedTangent& to : groups.borrowed) tangents[to.corner] = tangents[to.from];
    return tangents;
}

} // namespace pertev
