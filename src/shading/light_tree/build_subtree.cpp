#include "shading/light_tree/build_subtree.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <numeric>
#include <optional>
#include <utility>

#include "base/parallel_for.h"
#include "math/hilbert_curve.h"
#include "math/portable_math.h"
#include "shading/light_tree/light_tree.h"

namespace pertev {
namespace {

constexpr uint32_t kChunk = 1u << 14, kParallel = 1u << 12, kFewest = 4;
constexpr int kMaxDepth = 64; // beyond, ranges are halved
constexpr uint32_t kHilbert = 32;

/// Four floats, of which three are coordinates: sums over bins take most of a build's time.
using Floats4 = float __attribute__((vector_size(16)));
Floats4 floats4(Vec3 v, float last = 0) { return Floats4{v.x, v.y, v.z, last}; }
Vec3 vec3(Floats4 v) { return {v[0], v[1], v[2]}; }

/// A light of a tree that is being built.
struct Item {
    Floats4 lo, hi; // box of the light; both fourth lanes are the angle of emission
    Floats4 sum;    // normal, or 0 if light leaves in all directions or from both faces; power
    uint32_t light; // index into the builder's lights

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

float angle_between(Vec3 a, Vec3 b) { return acos(clamp(dot(a, b), -1.0f, 1.0f)); }

NormalCone unite(NormalCone a, NormalCone b) {
    if (b.normals > a.normals) std::swap(a, b);
    NormalCone both = a;
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
uint32_t pack_angles(const NormalCone& cone) {
    const float cos_normals = cone.normals < kPi ? cos(cone.normals) : -1.0f;
    const float cos_emission = cone.emission < kPi ? cos(cone.emission) : -1.0f;
    const int n = to_int((cos_normals + 1.0f) * 2047.0f, 0, 4094);
    const float stored = static_cast<float>(n) * (1.0f / 2047.0f) - 1.0f;
    const int sine = to_int(safe_sqrt(1.0f - stored * stored) * 4095.0f + 0.5f, 0, 4095);
    const int e = to_int((cos_emission + 1.0f) * 63.0f + 1e-3f, 0, 126); // a right angle is exact
    const auto bits = [](int x) { return static_cast<uint32_t>(x); };
    return bits(n) | bits(sine) << 12 | bits(e) << 24 | (cone.has_two_sides ? 1u << 31 : 0u);
}

/// A range of items, in one of two buffers, and the bounds of their centres if they are known.
struct Range {
    Item* items; // its buffer, in which it begins at begin
    uint32_t begin, end;
    std::optional<Centres> centres;

    uint32_t size() const { return end - begin; }
    bool is_large() const { return size() > 4 * kChunk; } // worth several threads
};

uint32_t chunks_of(uint64_t size) { return static_cast<uint32_t>((size + kChunk - 1) / kChunk); }

/// Runs body(chunk, from, to) over the chunks of a range in parallel.
template <class Body>
void for_chunks(uint32_t begin, uint32_t end, const Body& body) {
    parallel_for(chunks_of(end - begin), 1, [&](uint64_t chunk) {
        const auto from = static_cast<uint32_t>(begin + chunk * kChunk);
        body(chunk, from, std::min(end, from + kChunk));
    });
}

/// A built subtree, for its parent.
struct Built {
    Bounds3 bounds;
    NormalCone cone;
    float power;
};

/// Builds one tree, which is not empty.
class Builder {
public:
    Builder(std::span<const TreeLight> lights, const TreePlace& to) : lights_(lights), to_(to) {}

    Built build() {
        const Range all = collect();
        to_.nodes[to_.first_node] = {};
        if (all.is_large()) other_ = std::make_unique_for_overwrite<Item[]>(all.size());
        return build_range(all, to_.first_node + kLightTreeRoot, to_.first_node + 2, 0);
    }

private:
    /// Makes the items. Memory is first written in parallel, because the system's clearing of it would take as long as
    /// the rest of a large build.
    Range collect() {
        const auto lights = static_cast<uint32_t>(lights_.size());
        std::vector<double> powers(lights);
        std::vector<uint32_t> first(chunks_of(lights) + 1);
        for_chunks(0, lights, [&](uint64_t chunk, uint32_t from, uint32_t to) {
            for (uint32_t i = from; i < to; ++i) {
                powers[i] = has_leaf(lights_[i].power) ? lights_[i].power : 0;
                first[chunk + 1] += powers[i] > 0 ? 1 : 0;
            }
        });
        double sum = 0;
        for (const double power : powers) sum += power;
        std::partial_sum(first.begin(), first.end(), first.begin());
        items_ = std::make_unique_for_overwrite<Item[]>(first.back());
        std::vector<Centres> centres(first.size());
        for_chunks(0, lights, [&](uint64_t chunk, uint32_t from, uint32_t to) {
            uint32_t at = first[chunk];
            for (uint32_t i = from; i < to; ++i) {
                if (!(powers[i] > 0)) continue;
                const TreeLight& light = lights_[i];
                const bool has_axis = light.emission_angle < kPi && light.spread < kPi && !light.has_two_sides;
                // This is close to the length of the mean of normals.
                const float mean_cosine = light.spread > 0 ? 0.5f * (1 + cos(light.spread)) : 1.0f;
                const float power = max(static_cast<float>(powers[i] / sum), 0x1p-60f);
                items_[at] = {floats4(light.bounds.lo, light.emission_angle),
                              floats4(light.bounds.hi, light.emission_angle),
                              floats4(has_axis ? mean_cosine * light.axis : Vec3{}, power), i};
                centres[chunk].extend(items_[at++].centre());
            }
        });
        for (const Centres& part : centres) centres[0].extend(part);
        all_ = {vec3(centres[0].lo), vec3(centres[0].hi)};
        return {items_.get(), 0, first.back(), centres[0]};
    }

    NormalCone cone_of(const Item& item) const {
        const bool has_axis = item.sum[0] != 0 || item.sum[1] != 0 || item.sum[2] != 0;
        if (has_axis && item.light < to_.light_count) return {vec3(item.sum), 0, item.lo[3], false};
        const TreeLight& light = lights_[item.light]; // read only here: it is in no cache
        const bool is_isotropic = !(light.emission_angle < kPi);
        return {light.axis, is_isotropic ? kPi : light.spread, light.emission_angle, light.has_two_sides};
    }

    void store(uint32_t at, const Built& built, uint32_t next) {
        LightTreeNode& node = to_.nodes[at];
        node.centre = built.bounds.centre();
        node.power = built.power;
        const Vec3 centre = node.centre;
        node.radius = length(max(built.bounds.hi - centre, centre - built.bounds.lo));
        node.axis = pack_axis(built.cone.axis);
        NormalCone stored = built.cone; // about the axis as it is stored
        if (stored.normals < kPi) {
            stored.normals =
                min(stored.normals + angle_between(normalize(unpack_axis<float>(node.axis)), built.cone.axis), kPi);
        }
        node.angles = pack_angles(stored);
        node.next = next;
    }

    /// Builds the subtree over a range at node `at`, with the nodes below it from `below` on.
    Built build_range(const Range& range, uint32_t at, uint32_t below, int depth) {
        if (range.size() == 1) {
            const Item& item = range.items[range.begin];
            const Built built = {{vec3(item.lo), vec3(item.hi)}, cone_of(item), item.power()};
            const bool is_instance = item.light >= to_.light_count;
            to_.leaf_of_light[item.light] = at;
            store(at, built,
                  LightTreeNode::kLeaf |
                      (is_instance ? LightTreeNode::kInstance | (item.light - to_.light_count) : item.light));
            return built;
        }
        const auto [lower, upper] = split(range, depth);
        Built left, right;
        const auto build_left = [&, &half = lower] { left = build_range(half, below, below + 2, depth + 1); };
        const auto build_right = [&, &half = upper, next = below + 2 * lower.size()] {
            right = build_range(half, below + 1, next, depth + 1);
        };
        if (range.size() >= kParallel) {
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

    using Halves = std::array<Range, 2>;

    static Halves halves_at(const Range& range, uint32_t middle) {
        return {Range{range.items, range.begin, middle, {}}, Range{range.items, middle, range.end, {}}};
    }

    Halves split(const Range& range, int depth) {
        const uint32_t size = range.size();
        Item* const items = range.items + range.begin;
        if (size == 2) {
            order_pair(items);
            return halves_at(range, range.begin + 1);
        }
        const uint32_t half = range.begin + size / 2;
        if (levels_needed(size) >= kMaxDepth - depth) return halves_at(range, half);
        if (size <= kFewest) return halves_at(range, range.begin + split_few(items, size));
        if (size < 16) return split_by_bins<4>(range);
        return size < 64 ? split_by_bins<8>(range) : split_by_bins<12>(range);
    }

    template <std::size_t count>
    using Bins = std::array<std::array<Measure, count>, 3>;

    template <std::size_t count>
    Halves split_by_bins(const Range& range) {
        const uint32_t size = range.size();
        Item* const items = range.items + range.begin;
        const Centres centres = range.centres ? *range.centres : centres_of(items, size);
        std::vector<Bins<count>> of_chunk(range.is_large() ? chunks_of(size) : 0);
        const Split best = find_split(range, centres, of_chunk);
        if (best.axis < 0) return halves_at(range, range.begin + size / 2);
        bool lower_first = true;
        if (size >= kHilbert) {
            lower_first = hilbert_position(best.lower, all_) <= hilbert_position(best.upper, all_);
        }
        const auto is_left = [&](const Item& item) { return (best.bin_of(item, count) < best.bin) == lower_first; };
        if (!range.is_large()) return halves_at(range, range.begin + partition(items, size, is_left));
        return partition_in_chunks(range, best, lower_first, of_chunk, is_left);
    }

    static void order_pair(Item* items) {
        const Vec3 apart = vec3(items[1].centre() - items[0].centre()), size = abs(apart);
        const int axis = size.x >= size.y ? (size.x >= size.z ? 0 : 2) : (size.y >= size.z ? 1 : 2);
        if (component(apart, axis) < 0) std::swap(items[0], items[1]);
    }

    /// Tries every way to divide three or four items. Returns the number of the first half's.
    static uint32_t split_few(Item* items, uint32_t size) {
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
        const uint32_t middle = at;
        for (uint32_t i = 0; i < size; ++i) {
            if ((best >> i & 1) == 0) items[at++] = copy[i];
        }
        return middle;
    }

    template <std::size_t count>
    static void fill_bins(Bins<count>& bins, std::span<const Item> items, Floats4 lo, Floats4 scale) {
        const int last = static_cast<int>(count) - 1;
        for (const Item& item : items) {
            const Floats4 at = (item.centre() - lo) * scale;
            for (int axis = 0; axis < 3; ++axis) {
                bins[static_cast<std::size_t>(axis)][static_cast<std::size_t>(to_int(at[axis], 0, last))].add(item);
            }
        }
    }

    static Centres centres_of(const Item* items, uint32_t size) {
        Centres centres;
        for (uint32_t i = 0; i < size; ++i) centres.extend(items[i].centre());
        return centres;
    }

    /// Returns the best split of a range between bins. Fills `of_chunk` if the range is large.
    template <std::size_t count>
    static Split find_split(const Range& range, const Centres& centres, std::vector<Bins<count>>& of_chunk) {
        const Vec3 size = vec3(centres.hi - centres.lo);
        const auto scale_of = [&](float side) { return side > 0 ? static_cast<float>(count) / side : 0.0f; };
        const Floats4 scale = {scale_of(size.x), scale_of(size.y), scale_of(size.z), 0};
        Bins<count> bins;
        if (range.is_large()) {
            for_chunks(range.begin, range.end, [&](uint64_t chunk, uint32_t from, uint32_t to) {
                fill_bins(of_chunk[chunk], {range.items + from, range.items + to}, centres.lo, scale);
            });
            for (const Bins<count>& part : of_chunk) {
                for (std::size_t axis = 0; axis < 3; ++axis) {
                    for (std::size_t b = 0; b < count; ++b) bins[axis][b].add(part[axis][b]);
                }
            }
        } else {
            fill_bins(bins, {range.items + range.begin, range.items + range.end}, centres.lo, scale);
        }
        Split best;
        for (int axis = 0; axis < 3; ++axis) {
            const float side = component(size, axis);
            if (!(side > 0)) continue;
            const float regular = max_component(size) / side; // against thin boxes
            const auto& row = bins[static_cast<std::size_t>(axis)];
            std::array<Measure, count> above;
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

    /// Puts the left items first, and returns their number.
    template <class IsLeft>
    static uint32_t partition(Item* items, uint32_t size, const IsLeft& is_left) {
        uint32_t begin = 0, end = size;
        while (begin < end) {
            if (is_left(items[begin])) {
                ++begin;
            } else {
                std::swap(items[begin], items[--end]);
            }
        }
        return begin;
    }

    /// Copies a large range into the other buffer, the left items first. The bins of its chunks have their numbers.
    template <std::size_t count, class IsLeft>
    Halves partition_in_chunks(const Range& range, const Split& best, bool lower_first,
                               const std::vector<Bins<count>>& of_chunk, const IsLeft& is_left) {
        Item* const to = range.items == items_.get() ? other_.get() : items_.get();
        std::vector<uint32_t> left_at(of_chunk.size() + 1, range.begin);
        for (std::size_t chunk = 0; chunk < of_chunk.size(); ++chunk) {
            const auto& row = of_chunk[chunk][static_cast<std::size_t>(best.axis)];
            const uint32_t split = best.bin, from = lower_first ? 0 : split, end = lower_first ? split : count;
            left_at[chunk + 1] = left_at[chunk];
            for (uint32_t bin = from; bin < end; ++bin) left_at[chunk + 1] += row[bin].count;
        }
        const uint32_t middle = left_at.back();
        std::vector<std::array<Centres, 2>> centres(of_chunk.size());
        for_chunks(range.begin, range.end, [&](uint64_t chunk, uint32_t begin, uint32_t end) {
            uint32_t left = left_at[chunk], right = middle + (begin - range.begin) - (left - range.begin);
            for (uint32_t i = begin; i < end; ++i) {
                const Item& item = range.items[i];
                const bool goes_left = is_left(item);
                to[goes_left ? left++ : right++] = item;
                centres[chunk][goes_left ? 0 : 1].extend(item.centre());
            }
        });
        Halves halves = {Range{to, range.begin, middle, Centres()}, Range{to, middle, range.end, Centres()}};
        for (const auto& part : centres) {
            for (std::size_t side = 0; side < 2; ++side) halves[side].centres->extend(part[side]);
        }
        return halves;
    }

    std::span<const TreeLight> lights_;
    TreePlace to_;
    std::unique_ptr<Item[]> items_, other_;
    Bounds3 all_; // bounds of the centres
};

} // namespace

bool has_leaf(double power) { return std::isfinite(power) && power > 0; }

uint32_t count_leaves(std::span<const TreeLight> lights) {
    return static_cast<uint32_t>(std::ranges::count_if(lights, has_leaf, &TreeLight::power));
}

NormalCone build_subtree(std::span<const TreeLight> lights, const TreePlace& to) {
    return Builder(lights, to).build().cone;
}

} // namespace pertev
