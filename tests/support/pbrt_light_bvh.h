#pragma once

// A light BVH after the text of Pharr, Jakob and Humphreys, "Physically Based Rendering", 4th edition, 12.6.3, in
// double: an oracle of the variance that light_tree.h is held to. Written from the description, except for its clamp of
// a squared distance by a plain one: that is by the square of the radius.

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "shading/light_tree/build_light_tree.h"

namespace pertev::test {

class PbrtLightBvh {
public:
    explicit PbrtLightBvh(std::span<const TreeLight> lights) : lights_(lights), order_(lights.size()) {
        for (uint32_t i = 0; i < order_.size(); ++i) order_[i] = i;
        build(0, static_cast<uint32_t>(order_.size()));
    }

    /// Calls `visit(light, probability)` for each light of a probability above 0, for a point and a unit normal.
    template <class Visit>
    void visit(Vec3 point, Vec3 normal, const Visit& visit) const {
        visit_node(0, 1, point, normal, visit);
    }

private:
    static constexpr double kPiDouble = 3.141592653589793;
    static constexpr uint32_t kBuckets = 12;
    struct Cone {
        Vec3 axis = {0, 0, 1};
        double cosine = 2; // 2: empty; -1: all directions
    };
    struct Node {
        Bounds3 bounds;
        Cone normals;
        double power = 0, cos_emission = 1;
        bool has_two_sides = false;
        uint32_t right = 0, light = 0; // right 0: a leaf
    };

    static double as_double(float x) { return static_cast<double>(x); }
    static double dot_of(Vec3 a, Vec3 b) {
        return as_double(a.x) * as_double(b.x) + as_double(a.y) * as_double(b.y) + as_double(a.z) * as_double(b.z);
    }
    static double sine(double cosine) { return std::sqrt(std::max(1 - cosine * cosine, 0.0)); }
    static double cos_difference(double cos_a, double cos_b) { // cosine of a - b; 1 if that is negative
        return cos_a > cos_b ? 1 : cos_a * cos_b + sine(cos_a) * sine(cos_b);
    }

    static Cone unite(const Cone& a, const Cone& b) {
        if (a.cosine > 1) return b;
        if (b.cosine > 1) return a;
        const double theta_a = std::acos(a.cosine), theta_b = std::acos(b.cosine);
        const double between = std::acos(std::clamp(dot_of(a.axis, b.axis), -1.0, 1.0));
        if (std::min(between + theta_b, kPiDouble) <= theta_a) return a;
        if (std::min(between + theta_a, kPiDouble) <= theta_b) return b;
        const double theta = (theta_a + between + theta_b) / 2;
        const Vec3 across = b.axis - static_cast<float>(dot_of(a.axis, b.axis)) * a.axis;
        if (theta >= kPiDouble || !(length_squared(across) > 0)) return {{0, 0, 1}, -1};
        const double turn = theta - theta_a;
        return {normalize(static_cast<float>(std::cos(turn)) * a.axis +
                          static_cast<float>(std::sin(turn)) * normalize(across)),
                std::cos(theta)};
    }
    static Node unite(const Node& a, const Node& b) {
        if (!(a.power > 0)) return b;
        if (!(b.power > 0)) return a;
        Node both = a;
        both.bounds.extend(b.bounds);
        both.normals = unite(a.normals, b.normals);
        both.power += b.power;
        both.cos_emission = std::min(a.cos_emission, b.cos_emission);
        both.has_two_sides = a.has_two_sides || b.has_two_sides;
        return both;
    }
    Node leaf_of(uint32_t light) const {
        const TreeLight& of = lights_[light];
        const bool is_isotropic = of.emission_angle >= kPi;
        return {of.bounds,
                {of.axis, is_isotropic ? -1.0 : 1.0},
                of.power,
                std::cos(as_double(of.emission_angle)),
                of.has_two_sides,
                0,
                light};
    }

    static double cost(const Node& node, const Bounds3& whole, int axis) {
        const double theta_o = std::acos(node.normals.cosine), theta_e = std::acos(node.cos_emission);
        const double theta_w = std::min(theta_o + theta_e, kPiDouble), sin_o = sine(node.normals.cosine);
        const double measure =
            2 * kPiDouble * (1 - node.normals.cosine) +
            kPiDouble / 2 *
                (2 * theta_w * sin_o - std::cos(theta_o - 2 * theta_w) - 2 * theta_o * sin_o + node.normals.cosine);
        const double regular = as_double(max_component(whole.size())) / as_double(component(whole.size(), axis));
        return node.power * measure * regular * 2 * as_double(node.bounds.half_area());
    }

    uint32_t build(uint32_t begin, uint32_t end) {
        const auto at = static_cast<uint32_t>(nodes_.size());
        nodes_.emplace_back();
        if (end - begin == 1) {
            nodes_[at] = leaf_of(order_[begin]);
            return at;
        }
        Bounds3 whole, centres;
        for (uint32_t i = begin; i < end; ++i) {
            whole.extend(lights_[order_[i]].bounds);
            centres.extend(lights_[order_[i]].bounds.centre());
        }
        const auto bucket_of = [&](uint32_t light, int axis) {
            const float offset =
                component(lights_[light].bounds.centre() - centres.lo, axis) / component(centres.size(), axis);
            return std::min(static_cast<uint32_t>(offset * kBuckets), kBuckets - 1);
        };
        double least = kInfinity;
        int best_axis = -1;
        uint32_t best = 0;
        for (int axis = 0; axis < 3; ++axis) {
            if (!(component(centres.size(), axis) > 0)) continue;
            Node buckets[kBuckets];
            for (uint32_t i = begin; i < end; ++i) {
                Node& bucket = buckets[bucket_of(order_[i], axis)];
                bucket = unite(bucket, leaf_of(order_[i]));
            }
            for (uint32_t b = 0; b + 1 < kBuckets; ++b) {
                Node below, above;
                for (uint32_t k = 0; k <= b; ++k) below = unite(below, buckets[k]);
                for (uint32_t k = b + 1; k < kBuckets; ++k) above = unite(above, buckets[k]);
                if (!(below.power > 0) || !(above.power > 0)) continue;
                const double sum = cost(below, whole, axis) + cost(above, whole, axis);
                if (sum > 0 && sum < least) least = sum, best_axis = axis, best = b;
            }
        }
        uint32_t middle = begin;
        if (best_axis >= 0) {
            const auto from = order_.begin();
            middle = static_cast<uint32_t>(
                std::partition(from + begin, from + end,
                               [&](uint32_t light) { return bucket_of(light, best_axis) <= best; }) -
                from);
        }
        if (middle == begin || middle == end) middle = (begin + end) / 2;
        build(begin, middle);
        const uint32_t right = build(middle, end);
        nodes_[at] = unite(nodes_[at + 1], nodes_[right]);
        nodes_[at].right = right;
        return at;
    }

    static double importance(const Node& node, Vec3 point, Vec3 normal) {
        const Vec3 centre = node.bounds.centre();
        const double radius_squared = dot_of(node.bounds.size(), node.bounds.size()) / 4;
        const double distance_squared = dot_of(point - centre, point - centre);
        const Vec3 wi = normalize(point - centre);
        double cos_w = dot_of(node.normals.axis, wi);
        if (node.has_two_sides) cos_w = std::abs(cos_w);
        const double cos_b = distance_squared < radius_squared ? -1 : std::sqrt(1 - radius_squared / distance_squared);
        const double cos_x = cos_difference(cos_w, node.normals.cosine);
        const double cos_p = cos_difference(cos_x, cos_b);
        if (cos_p <= node.cos_emission) return 0;
        const double cos_i = std::abs(dot_of(wi, normal));
        return std::max(node.power * cos_p * cos_difference(cos_i, cos_b) / std::max(distance_squared, radius_squared),
                        0.0);
    }

    template <class Visit>
    void visit_node(uint32_t at, double probability, Vec3 point, Vec3 normal, const Visit& visit) const {
        const Node& node = nodes_[at];
        if (node.right == 0) return visit(node.light, probability);
        const double left = importance(nodes_[at + 1], point, normal);
        const double right = importance(nodes_[node.right], point, normal);
        if (!(left + right > 0)) return;
        if (left > 0) visit_node(at + 1, probability * left / (left + right), point, normal, visit);
        if (right > 0) visit_node(node.right, probability * right / (left + right), point, normal, visit);
    }

    std::span<const TreeLight> lights_;
    std::vector<uint32_t> order_;
    std::vector<Node> nodes_;
};

} // namespace pertev::test
