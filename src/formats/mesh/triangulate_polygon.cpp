#include "formats/mesh/triangulate_polygon.h"

#include "math/vec2.h"

namespace pertev {
namespace {

/// Returns twice the signed area of (a, b, c), in double, so that it keeps its precision for large coordinates.
double area2(Vec2 a, Vec2 b, Vec2 c) {
    const double abx = static_cast<double>(b.x) - static_cast<double>(a.x);
    const double aby = static_cast<double>(b.y) - static_cast<double>(a.y);
    const double acx = static_cast<double>(c.x) - static_cast<double>(a.x);
    const double acy = static_cast<double>(c.y) - static_cast<double>(a.y);
    return abx * acy - aby * acx;
}

/// Returns whether `p` lies in a counter-clockwise triangle or on its edge.
bool covers(Vec2 a, Vec2 b, Vec2 c, Vec2 p) {
    return area2(a, b, p) >= 0 && area2(b, c, p) >= 0 && area2(c, a, p) >= 0;
}

Vec3 newell_normal(std::span<const Vec3> polygon) {
    Vec3 normal;
    for (std::size_t i = 0; i < polygon.size(); ++i) {
        // Relative to the first corner: far from the origin the products would cancel.
        const Vec3 a = polygon[i] - polygon[0], b = polygon[(i + 1) % polygon.size()] - polygon[0];
        normal += cross(a, b);
    }
    return normal;
}

/// Projects the polygon along the normal's largest axis, mirrored if necessary so that it is counter-clockwise.
std::vector<Vec2> project(std::span<const Vec3> polygon, Vec3 normal) {
    const Vec3 size = abs(normal);
    const int axis = size.x >= size.y ? (size.x >= size.z ? 0 : 2) : (size.y >= size.z ? 1 : 2);
    const bool flip = component(normal, axis) < 0;
    std::vector<Vec2> flat(polygon.size());
    for (std::size_t i = 0; i < polygon.size(); ++i) {
        const float x = component(polygon[i], (axis + 1) % 3), y = component(polygon[i], (axis + 2) % 3);
        flat[i] = flip ? Vec2{y, x} : Vec2{x, y};
    }
    return flat;
}

class EarClipper {
public:
    explicit EarClipper(std::vector<Vec2> flat) : p_(std::move(flat)), budget_(4096 + 64 * p_.size()) {
        const auto n = static_cast<uint32_t>(p_.size());
        for (uint32_t i = 0; i < n; ++i) left_.push_back(i);
        for (uint32_t i = 0; i < n; ++i) {
            if (area2(p_[(i + n - 1) % n], p_[i], p_[(i + 1) % n]) < 0) reflex_.push_back(i);
        }
    }

    bool is_convex() const { return reflex_.empty(); }

    void run(std::vector<uint32_t>& triangles) {
        std::size_t at = 0, failed = 0;
        while (left_.size() > 3 && failed < left_.size() && budget_ > 0) {
            const std::size_t n = left_.size();
            at %= n;
            const uint32_t a = left_[(at + n - 1) % n], b = left_[at], c = left_[(at + 1) % n];
            if (!is_ear(a, b, c)) {
                ++at, ++failed;
                continue;
            }
            triangles.insert(triangles.end(), {a, b, c});
            left_.erase(left_.begin() + static_cast<std::ptrdiff_t>(at));
            spend(n / 64); // moving the rest down is quick, but not free for a very long list
            failed = 0;
        }
        for (std::size_t i = 1; i + 1 < left_.size(); ++i) {
            triangles.insert(triangles.end(), {left_[0], left_[i], left_[i + 1]});
        }
    }

private:
    void spend(std::size_t tests) { budget_ = budget_ > tests ? budget_ - tests : 0; }

    bool is_ear(uint32_t a, uint32_t b, uint32_t c) {
        spend(1 + reflex_.size());
        if (area2(p_[a], p_[b], p_[c]) <= 0) return false;
        // Only a corner that was reflex at the start can lie in an ear.
        for (const uint32_t r : reflex_) {
            if (r == a || r == b || r == c) continue;
            if (p_[r] == p_[a] || p_[r] == p_[b] || p_[r] == p_[c]) continue;
            if (covers(p_[a], p_[b], p_[c], p_[r])) return false;
        }
        return true;
    }

    std::vector<Vec2> p_;
    std::vector<uint32_t> left_, reflex_;
    std::size_t budget_;
};

} // namespace

void triangulate_polygon(std::span<const Vec3> polygon, std::vector<uint32_t>& triangles) {
    if (polygon.size() < 3) return;
    if (polygon.size() > 3) {
        const Vec3 normal = newell_normal(polygon);
        if (is_finite(normal) && !(normal == Vec3{})) {
            EarClipper clipper(project(polygon, normal));
            if (!clipper.is_convex()) {
                clipper.run(triangles);
                return;
            }
        }
    }
    for (uint32_t i = 1; i + 1 < polygon.size(); ++i) triangles.insert(triangles.end(), {0u, i, i + 1});
}

} // namespace pertev
