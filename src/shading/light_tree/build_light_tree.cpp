#include "shading/light_tree/build_light_tree.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "base/parallel_for.h"
#include "math/hilbert_curve.h"
#include "math/portable_math.h"
#include "shading/light_tree/light_tree.h"

namespace pertev {
namespace {

constexpr uint32_t kMostBins = 12, kChunk = 1u << 14, kParallel = 1u << 12, kFewest = 4;
constexpr int kMaxDepth = 64; // beyond, ranges are halved
constexpr uint32_t kHilbert = 32;

/// Returns whether a tree holds the light. Its power is infinite where the square of an area overflows.
bool has_leaf(const TreeLight& light) { return std::isfinite(light.power) && light.power > 0; }

/// Four floats, of which three are coordinates: sums over bins take most of a build's time.
using Floats4 = float __attribute__((vector_size(16)));
Floats4 floats4(Vec3 v, float last = 0) { return Floats4{v.x, v.y, v.z, last}; }
Vec3 vec3(Floats4 v) { return {v[0], v[1], v[2]}; }

/// A light of a tree that is being built.
struct Item {
    Floats4 lo, hi;
    Floats4 sum; // normal, or 0 if light leaves in all directions or from both faces; power
    uint32_t light;

    Floats4 centre() const { return 0.5f * (lo + hi); }
    float power() const { return sum[3]; }
};

/// Sums and bounds of a set of lights, for the heuristic.
struct Measure {
    Floats4 lo = floats4({kInfinity, kInfinity, kInfinity}), hi = -lo;
    Floats4 sum = {}; // sum of normals and, last, of powers
    uint32_t count = 0;

    template <class Part> // an Item or a Measure
    void extend(const Part& part) {
        lo = part.lo < lo ? part.lo : lo;
        hi = part.hi > hi ? part.hi : hi;
        sum += part.sum;
    }
    void add(const Item& item) { extend(item), ++count; }
    void add(const Measure& other) { extend(other), count += other.count; }
    /// Power times the size of the box times an orientation measure, which with R, the length of the mean of normals,
    /// is close to Conty Estevez and Kulla's integral over the cone of half angle acos(2 R - 1).
    float cost() const {
        const float number = static_cast<float>(count);
        return sum[3] * length_squared(vec3(hi - lo)) * (4.0f - 3.0f * length_squared(vec3(sum)) / (number * number));
    }
    Vec3 centre() const { return vec3(0.5f * (lo + hi)); }
};

/// Bounds of the centres of lights.
struct Centres {
    Floats4 lo = floats4({kInfinity, kInfinity, kInfinity}), hi = -lo;

    void extend(Floats4 centre) { extend({centre, centre}); }
    void extend(const Centres& other) {
        lo = other.lo < lo ? other.lo : lo;
        hi = other.hi > hi ? other.hi : hi;
    }
};

struct Split {
    float cost = kInfinity;
    int axis = -1;
    float lo = 0, scale = 0;
    uint32_t bin = 0;  // bins before it are on the lower side
    Vec3 lower, upper; // middles of both sides

    uint32_t bin_of(const Item& item, uint32_t bins) const {
        return static_cast<uint32_t>(to_int((item.centre()[axis] - lo) * scale, 0, static_cast<int>(bins) - 1));
    }
};

/// A cone of normals of a tree that is being built.
struct Cone {
    Vec3 axis = {0, 0, 1};
    float normals = 0, emission = 0; // half angle of normals, angle of emission about one; radians
    bool has_two_sides = false;
};

float angle_between(Vec3 a, Vec3 b) { return acos(clamp(dot(a, b), -1.0f, 1.0f)); }

Cone unite(Cone a, Cone b) {
    if (b.normals > a.normals) std::swap(a, b);
    Cone both = a;
    both.emission = max(a.emission, b.emission);
    both.has_two_sides = a.has_two_sides || b.has_two_sides;
    if (a.normals >= kPi) return both;
    if (both.has_two_sides && dot(a.axis, b.axis) < 0 && (a.has_two_sides || b.has_two_sides)) {
        if (b.has_two_sides) {
            b.axis = -b.axis;
        } else {
            both.axis = a.axis = -a.axis;
        }
    }
    const float between = angle_between(a.axis, b.axis);
    if (between + b.normals <= a.normals) return both;
    both.normals = 0.5f * (a.normals + between + b.normals);
    if (!(both.normals < kPi)) {
        both.normals = kPi;
        return both;
    }
    const Vec3 across = b.axis - dot(a.axis, b.axis) * a.axis;
    const float turn = both.normals - a.normals;
    if (!(length_squared(across) > 1e-12f)) { // opposite or equal axes
        if (between > 1) both.normals = kPi;
        return both;
    }
    both.axis = normalize(cos(turn) * a.axis + sin(turn) * normalize(across));
    return both;
}

uint32_t pack_axis(Vec3 d) {
    const auto word = [](float c) { return static_cast<uint32_t>(to_int(c * 511.0f + 511.5f, 0, 1022)); };
    return word(d.x) | word(d.y) << 10 | word(d.z) << 20;
}

/// Packs a cone, rounded to a wider one.
uint32_t pack_angles(const Cone& cone) {
    const float cos_normals = cone.normals < kPi ? cos(cone.normals) : -1.0f;
    const float cos_emission = cone.emission < kPi ? cos(cone.emission) : -1.0f;
    const int n = to_int((cos_normals + 1.0f) * 2047.0f, 0, 4094);
    const float stored = static_cast<float>(n) * (1.0f / 2047.0f) - 1.0f;
    const int sine = to_int(safe_sqrt(1.0f - stored * stored) * 4095.0f + 0.5f, 0, 4095);
    const int e = to_int((cos_emission + 1.0f) * 63.0f + 1e-3f, 0, 126); // a right angle is exact
    const auto bits = [](int x) { return static_cast<uint32_t>(x); };
    return bits(n) | bits(sine) << 12 | bits(e) << 24 | (cone.has_two_sides ? 1u << 31 : 0u);
}

class Builder {
public:
    Builder(std::span<const TreeLight> lights, LightTreeData& data) : lights_(lights), data_(data) {}

    void build() {
        collect();
        data_.leaf_of_light.assign(lights_.size(), 0);
        if (items_.empty()) return;
        const auto count = static_cast<uint32_t>(items_.size());
        data_.nodes.resize(2 * static_cast<std::size_t>(count));
        if (count > kParallel) other_.resize(count);
        build_range(0, count, kLightTreeRoot, 2, 0);
    }

private:
    /// A built subtree, for its parent.
    struct Built {
        Bounds3 bounds;
        Cone cone;
        float power;
    };

    void collect() {
        std::vector<double> powers(lights_.size());
        for (std::size_t i = 0; i < lights_.size(); ++i) {
            powers[i] = has_leaf(lights_[i]) ? lights_[i].power : 0;
        }
        double sum = 0;
        for (const double power : powers) sum += power;
        std::size_t count = 0;
        std::vector<uint32_t> position(lights_.size());
        for (std::size_t i = 0; i < lights_.size(); ++i) {
            position[i] = static_cast<uint32_t>(count);
            count += powers[i] > 0 ? 1 : 0;
        }
        items_.resize(count);
        parallel_for(lights_.size(), 4096, [&](uint64_t i) {
            if (!(powers[i] > 0)) return;
            const TreeLight& light = lights_[i];
            const bool has_axis = light.emission_angle < kPi && !light.has_two_sides;
            const float power = max(static_cast<float>(powers[i] / sum), 0x1p-60f);
            items_[position[i]] = {floats4(light.bounds.lo), floats4(light.bounds.hi),
                                   floats4(has_axis ? light.axis : Vec3{}, power), static_cast<uint32_t>(i)};
        });
        for (const Item& item : items_) all_.extend(vec3(item.centre()));
    }

    Cone cone_of(const Item& item) const {
        const TreeLight& light = lights_[item.light];
        const bool is_isotropic = !(light.emission_angle < kPi);
        return {light.axis, is_isotropic ? kPi : 0.0f, light.emission_angle, light.has_two_sides};
    }

    void store(uint32_t at, const Built& built, uint32_t next) {
        LightTreeNode& node = data_.nodes[at];
        node.centre = built.bounds.centre();
        node.power = built.power;
        const Vec3 centre = node.centre;
        node.radius = length(max(built.bounds.hi - centre, centre - built.bounds.lo));
        node.axis = pack_axis(built.cone.axis);
        Cone stored = built.cone; // about the axis as it is stored
        if (stored.normals < kPi) {
            stored.normals =
                min(stored.normals + angle_between(normalize(unpack_axis<float>(node.axis)), built.cone.axis), kPi);
        }
        node.angles = pack_angles(stored);
        node.next = next;
    }

    /// Builds the subtree over items [begin, end) at node `at`, with the nodes below it from `below` on.
    Built build_range(uint32_t begin, uint32_t end, uint32_t at, uint32_t below, int depth) {
        const uint32_t size = end - begin;
        if (size == 1) {
            const Item& item = items_[begin];
            const Built built = {lights_[item.light].bounds, cone_of(item), item.power()};
            data_.leaf_of_light[item.light] = at;
            store(at, built, LightTreeNode::kLeaf | item.light);
            return built;
        }
        const uint32_t middle = split(begin, end, depth);
        const uint32_t of_left = middle - begin;
        Built left, right;
        const auto build_left = [&] { left = build_range(begin, middle, below, below + 2, depth + 1); };
        const auto build_right = [&] { right = build_range(middle, end, below + 1, below + 2 * of_left, depth + 1); };
        if (size >= kParallel) {
            parallel_invoke(build_left, build_right);
        } else {
            build_left();
            build_right();
        }
        Built built = {left.bounds, unite(left.cone, right.cone), left.power + right.power};
        built.bounds.extend(right.bounds);
        store(at, built, below);
        return built;
    }

    static int levels_needed(uint32_t size) {
        int levels = 0;
        while ((uint64_t(1) << levels) < size) ++levels;
        return levels;
    }

    uint32_t split(uint32_t begin, uint32_t end, int depth) {
        const uint32_t size = end - begin;
        if (size == 2) {
            order_pair(begin);
            return begin + 1;
        }
        if (levels_needed(size) >= kMaxDepth - depth) return begin + size / 2;
        if (size <= kFewest) return split_few(begin, size);
        const uint32_t bins = size >= 64 ? kMostBins : size >= 16 ? 8u : 4u;
        const Split best = find_split(begin, end, bins);
        if (best.axis < 0) return begin + size / 2;
        bool lower_first = true;
        if (size >= kHilbert) {
            lower_first = hilbert_position(best.lower, all_) <= hilbert_position(best.upper, all_);
        }
        const auto is_left = [&](const Item& item) { return (best.bin_of(item, bins) < best.bin) == lower_first; };
        const uint32_t middle =
            size > 4 * kChunk ? partition_in_chunks(begin, end, is_left) : partition(begin, end, is_left);
        return middle;
    }

    void order_pair(uint32_t begin) {
        const Vec3 apart = vec3(items_[begin + 1].centre() - items_[begin].centre()), size = abs(apart);
        const int axis = size.x >= size.y ? (size.x >= size.z ? 0 : 2) : (size.y >= size.z ? 1 : 2);
        if (component(apart, axis) < 0) std::swap(items_[begin], items_[begin + 1]);
    }

    /// Tries every way to divide three or four items.
    uint32_t split_few(uint32_t begin, uint32_t size) {
        Item* const items = items_.data() + begin;
        uint32_t best = 1;
        float least = kInfinity;
        for (uint32_t set = 1; set < 1u << (size - 1); ++set) { // the last item is never in it
            Measure in, out;
            for (uint32_t i = 0; i < size; ++i) ((set >> i & 1) != 0 ? in : out).add(items[i]);
            const float cost = in.cost() + out.cost();
            if (cost < least) least = cost, best = set;
        }
        std::array<Item, kFewest> copy;
        std::copy_n(items, size, copy.begin());
        uint32_t at = 0;
        for (uint32_t i = 0; i < size; ++i) {
            if ((best >> i & 1) != 0) items[at++] = copy[i];
        }
        const uint32_t middle = begin + at;
        for (uint32_t i = 0; i < size; ++i) {
            if ((best >> i & 1) == 0) items[at++] = copy[i];
        }
        return middle;
    }

    using Bins = std::array<std::array<Measure, kMostBins>, 3>;

    void fill_bins(Bins& bins, uint32_t begin, uint32_t end, Floats4 lo, Floats4 scale, uint32_t count) const {
        const int last = static_cast<int>(count) - 1;
        for (uint32_t i = begin; i < end; ++i) {
            const Item& item = items_[i];
            const Floats4 at = (item.centre() - lo) * scale;
            for (int axis = 0; axis < 3; ++axis) {
                bins[static_cast<std::size_t>(axis)][static_cast<std::size_t>(to_int(at[axis], 0, last))].add(item);
            }
        }
    }

    Split find_split(uint32_t begin, uint32_t end, uint32_t count) const {
        Centres centres;
        const uint32_t chunks = (end - begin + kChunk - 1) / kChunk;
        if (chunks > 4) {
            std::vector<Centres> of_chunk(chunks);
            parallel_for(chunks, 1, [&](uint64_t chunk) {
                const auto from = static_cast<uint32_t>(begin + chunk * kChunk);
                for (uint32_t i = from; i < std::min(end, from + kChunk); ++i)
                    of_chunk[chunk].extend(items_[i].centre());
            });
            for (const Centres& bounds : of_chunk) centres.extend(bounds);
        } else {
            for (uint32_t i = begin; i < end; ++i) centres.extend(items_[i].centre());
        }
        const Vec3 size = vec3(centres.hi - centres.lo);
        const auto scale_of = [&](float side) { return side > 0 ? static_cast<float>(count) / side : 0.0f; };
        const Floats4 scale = {scale_of(size.x), scale_of(size.y), scale_of(size.z), 0};
        Bins bins;
        if (chunks > 4) {
            std::vector<Bins> of_chunk(chunks);
            parallel_for(chunks, 1, [&](uint64_t chunk) {
                const auto from = static_cast<uint32_t>(begin + chunk * kChunk);
                fill_bins(of_chunk[chunk], from, std::min(end, from + kChunk), centres.lo, scale, count);
            });
            for (const Bins& part : of_chunk) {
                for (std::size_t axis = 0; axis < 3; ++axis) {
                    for (std::size_t b = 0; b < count; ++b) bins[axis][b].add(part[axis][b]);
                }
            }
        } else {
            fill_bins(bins, begin, end, centres.lo, scale, count);
        }
        Split best;
        for (int axis = 0; axis < 3; ++axis) {
            const float side = component(size, axis);
            if (!(side > 0)) continue;
            const float regular = max_component(size) / side; // against thin boxes
            const auto& row = bins[static_cast<std::size_t>(axis)];
            std::array<Measure, kMostBins> above;
            Measure sum;
            for (uint32_t b = count; b-- > 1;) {
                if (row[b].count > 0) sum.add(row[b]);
                above[b] = sum;
            }
            sum = {};
            for (uint32_t b = 1; b < count; ++b) {
                if (row[b - 1].count == 0) continue; // the split before is as good
                sum.add(row[b - 1]);
                if (above[b].count == 0) break;
                const float cost = regular * (sum.cost() + above[b].cost());
                if (!(cost < best.cost)) continue;
                best = {cost, axis, centres.lo[axis], scale[axis], b, sum.centre(), above[b].centre()};
            }
        }
        return best;
    }

    template <class IsLeft>
    uint32_t partition(uint32_t begin, uint32_t end, const IsLeft& is_left) {
        while (begin < end) {
            if (is_left(items_[begin])) {
                ++begin;
            } else {
                std::swap(items_[begin], items_[--end]);
            }
        }
        return begin;
    }

    template <class IsLeft>
    uint32_t partition_in_chunks(uint32_t begin, uint32_t end, const IsLeft& is_left) {
        const uint32_t chunks = (end - begin + kChunk - 1) / kChunk;
        std::vector<uint32_t> lefts(chunks);
        const auto range_of = [&](uint64_t chunk) {
            const auto from = static_cast<uint32_t>(begin + chunk * kChunk);
            return std::pair(from, std::min(end, from + kChunk));
        };
        parallel_for(chunks, 1, [&](uint64_t chunk) {
            const auto [from, to] = range_of(chunk);
            for (uint32_t i = from; i < to; ++i) lefts[chunk] += is_left(items_[i]) ? 1 : 0;
        });
        uint32_t middle = begin;
        for (const uint32_t count : lefts) middle += count;
        std::vector<uint32_t> left_at(chunks), right_at(chunks);
        uint32_t left = begin, right = middle;
        for (uint32_t chunk = 0; chunk < chunks; ++chunk) {
            left_at[chunk] = left, right_at[chunk] = right;
            const auto [from, to] = range_of(chunk);
            left += lefts[chunk], right += to - from - lefts[chunk];
        }
        parallel_for(chunks, 1, [&](uint64_t chunk) {
            const auto [from, to] = range_of(chunk);
            uint32_t l = left_at[chunk], r = right_at[chunk];
            for (uint32_t i = from; i < to; ++i) other_[is_left(items_[i]) ? l++ : r++] = items_[i];
        });
        parallel_for(chunks, 1, [&](uint64_t chunk) {
            const auto [from, to] = range_of(chunk);
            std::copy(other_.begin() + from, other_.begin() + to, items_.begin() + from);
        });
        return middle;
    }

    std::span<const TreeLight> lights_;
    LightTreeData& data_;
    std::vector<Item> items_, other_;
    Bounds3 all_; // bounds of the centres
};

} // namespace

LightTreeData build_light_tree(std::span<const TreeLight> lights) {
    LightTreeData data;
    Builder(lights, data).build();
    return data;
}

RequestedLightTree::RequestedLightTree(std::vector<TreeLight> lights)
    : lights_(std::move(lights)), light_count_(static_cast<uint32_t>(std::ranges::count_if(lights_, has_leaf))) {}

const LightTreeData& RequestedLightTree::get() const {
    std::call_once(once_, [&] {
        data_ = build_light_tree(lights_);
        lights_ = {};
        is_built_ = true;
    });
    return data_;
}

} // namespace pertev
