#include "radiosity/cluster_tree.h"

#include <algorithm>

#include "math/bounds3.h"

namespace pertev {
namespace {

constexpr float kAlike = 1; // maximum difference of any component of two similar normals

int longest_axis(Vec3 size) { return size.x >= size.y ? (size.x >= size.z ? 0 : 2) : (size.y >= size.z ? 1 : 2); }

class ClusterMaker {
public:
    ClusterMaker(std::span<const Ball> balls, std::span<const Vec3> normals, std::span<const int> levels)
        : balls_(balls), normals_(normals), levels_(levels) {
        for (uint32_t i = 0; i < balls.size(); ++i) order_.push_back(i);
    }

    /// Makes the cluster of a range, before those below it, and returns its number.
    uint32_t make(uint32_t first, uint32_t count) {
        const auto number = static_cast<uint32_t>(clusters_.size());
        clusters_.push_back({.first = first, .count = count});
        if (count == 1) {
            clusters_[number].ball = balls_[order_[first]];
            return number;
        }
        const uint32_t before = part(first, count);
        const uint32_t left = make(first, before);
        const uint32_t right = make(first + before, count - before);
        Cluster& cluster = clusters_[number];
        cluster.left = left, cluster.right = right;
        cluster.ball = ball_round(clusters_[left].ball, clusters_[right].ball);
        return number;
    }

    const std::vector<uint32_t>& order() const { return order_; }
    std::vector<Cluster> take() { return std::move(clusters_); }

private:
    /// Moves the faces of the left half to the front. Returns their number.
    uint32_t part(uint32_t first, uint32_t count) {
        const auto begin = order_.begin() + first, end = begin + count;
        Bounds3 positions, normals;
        int lowest = levels_[*begin], highest = lowest;
        for (auto i = begin; i != end; ++i) {
            positions.extend(balls_[*i].centre);
            normals.extend(normals_[*i]);
            lowest = std::min(lowest, levels_[*i]), highest = std::max(highest, levels_[*i]);
        }
        if (lowest != highest) {
            const auto is_left = [&](uint32_t i) { return 2 * levels_[i] < lowest + highest; };
            return static_cast<uint32_t>(std::stable_partition(begin, end, is_left) - begin);
        }
        const Vec3 spread = normals.size();
        if (max_component(spread) > kAlike) {
            const int axis = longest_axis(spread);
            const float middle = 0.5f * (component(normals.lo, axis) + component(normals.hi, axis));
            const auto is_left = [&](uint32_t i) { return component(normals_[i], axis) < middle; };
            return static_cast<uint32_t>(std::stable_partition(begin, end, is_left) - begin);
        }
        const int axis = longest_axis(positions.size());
        const auto is_before = [&](uint32_t a, uint32_t b) {
            const float at_a = component(balls_[a].centre, axis), at_b = component(balls_[b].centre, axis);
            return at_a != at_b ? at_a < at_b : a < b;
        };
        std::nth_element(begin, begin + count / 2, end, is_before);
        return count / 2;
    }

    std::span<const Ball> balls_;
    std::span<const Vec3> normals_;
    std::span<const int> levels_;
    std::vector<uint32_t> order_;
    std::vector<Cluster> clusters_;
};

} // namespace

void SentLight::add(Vec3 n, Rgb power) {
    all += power;
    along[0] += n.x * power, along[1] += n.y * power, along[2] += n.z * power;
    twice[0] += (n.x * n.x) * power, twice[1] += (n.y * n.y) * power, twice[2] += (n.z * n.z) * power;
    twice[3] += (n.x * n.y) * power, twice[4] += (n.y * n.z) * power, twice[5] += (n.z * n.x) * power;
}

void SentLight::add(const SentLight& other) {
    all += other.all;
    for (int k = 0; k < 3; ++k) along[k] += other.along[k];
    for (int k = 0; k < 6; ++k) twice[k] += other.twice[k];
}

Rgb SentLight::towards(Vec3 d) const {
    const Rgb cosine = d.x * along[0] + d.y * along[1] + d.z * along[2];
    const Rgb square = (d.x * d.x) * twice[0] + (d.y * d.y) * twice[1] + (d.z * d.z) * twice[2] +
                       2.0f * ((d.x * d.y) * twice[3] + (d.y * d.z) * twice[4] + (d.z * d.x) * twice[5]);
    // max(c, 0) is about 1/4 + c / 2 + 5/32 (3 c^2 - 1).
    const Rgb sum = (3.0f / 32) * all + 0.5f * cosine + (15.0f / 32) * square;
    return {max(sum.r, 0.0f), max(sum.g, 0.0f), max(sum.b, 0.0f)};
}

Ball ball_round(const Ball& a, const Ball& b) {
    const Vec3 offset = b.centre - a.centre;
    const float distance = length(offset);
    if (distance + b.radius <= a.radius) return a;
    if (distance + a.radius <= b.radius) return b;
    const float radius = 0.5f * (distance + a.radius + b.radius);
    return {a.centre + ((radius - a.radius) / distance) * offset, radius};
}

ClusterTree make_clusters(std::span<const uint32_t> faces, std::span<const Ball> balls, std::span<const Vec3> normals,
                          std::span<const int> levels) {
    ClusterTree tree;
    ClusterMaker maker(balls, normals, levels);
    if (!faces.empty()) maker.make(0, static_cast<uint32_t>(faces.size()));
    for (const uint32_t i : maker.order()) tree.faces.push_back(faces[i]);
    tree.clusters = maker.take();
    return tree;
}

} // namespace pertev
