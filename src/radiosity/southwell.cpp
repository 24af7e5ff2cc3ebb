// Southwell relaxation (progressive refinement): the patch with the most unshot light shoots it to all visible
// patches, repeatedly. If this ends early, most of the light is distributed, and the rest is shown as ambient light.

#include <algorithm>
#include <bit>

#include "math/tree_sum.h"
#include "radiosity/radiosity_system.h"

namespace pertev {
namespace {

struct Receiver {
    uint32_t patch;
    float factor; // from the receiver to the sender
};

/// The patches that receive light from each patch, by ascending number.
class Receivers {
public:
    explicit Receivers(const RadiositySystem& system) : starts_(system.patches.size() + 1) {}

    /// Finds the receivers. Returns false if the solution must end.
    bool find(const RadiositySystem& system, const KeepSolving& keep_going) {
        const auto goes_on = [&](std::size_t i) { return i % 1024 != 0 || !keep_going || keep_going(1); };
        all_.resize(system.factor_count());
        for (std::size_t i = 0; i < system.patches.size(); ++i) {
            if (!goes_on(i)) return false;
            for (const FormFactor& from : system.row(i)) ++starts_[from.patch + 1];
        }
        for (std::size_t i = 1; i < starts_.size(); ++i) starts_[i] += starts_[i - 1];
        std::vector<uint64_t> next(starts_.begin(), starts_.end() - 1);
        for (std::size_t i = 0; i < system.patches.size(); ++i) {
            if (!goes_on(i)) return false;
            for (const FormFactor& from : system.row(i)) {
                all_[next[from.patch]++] = {static_cast<uint32_t>(i), from.factor};
            }
        }
        return true;
    }
    std::span<const Receiver> of(std::size_t sender) const {
        return {all_.data() + starts_[sender], static_cast<std::size_t>(starts_[sender + 1] - starts_[sender])};
    }

private:
    std::vector<uint64_t> starts_;
    std::vector<Receiver> all_;
};

/// Finds the patch with most unsent light, the first of several, by a tree of maxima, so that a change costs its
/// height.
class LargestUnsent {
public:
    explicit LargestUnsent(std::size_t count) : leaves_(std::bit_ceil(count)), largest_(2 * leaves_, 0.0) {}

    void set(std::size_t patch, double light) {
        std::size_t at = leaves_ + patch;
        largest_[at] = light;
        for (at /= 2; at > 0; at /= 2) {
            const double larger = std::max(largest_[2 * at], largest_[2 * at + 1]);
            if (largest_[at] == larger) return; // nothing changes above
            largest_[at] = larger;
        }
    }
    std::size_t first() const {
        std::size_t at = 1;
        while (at < leaves_) at = largest_[2 * at] >= largest_[2 * at + 1] ? 2 * at : 2 * at + 1;
        return at - leaves_;
    }

private:
    std::size_t leaves_;
    std::vector<double> largest_;
};

constexpr double kMinAbsorbed = 1e-6;
constexpr uint64_t kMinWork = 64; // fixed cost of a sending patch, in units of receiving patches

double light_of(const SystemPatch& patch, Rgb unsent) {
    return static_cast<double>(patch.area) *
           (static_cast<double>(unsent.r) + static_cast<double>(unsent.g) + static_cast<double>(unsent.b));
}

/// Sums over patches for the ambient light.
struct Spread {
    double area = 0, squared = 0;
    double arrives[3] = {}, reflected[3] = {}; // by channel
};

Spread operator+(const Spread& a, const Spread& b) {
    Spread sum = {a.area + b.area, a.squared + b.squared};
    for (int k = 0; k < 3; ++k) {
        sum.arrives[k] = a.arrives[k] + b.arrives[k];
        sum.reflected[k] = a.reflected[k] + b.reflected[k];
    }
    return sum;
}

/// Returns the irradiance if unsent light were distributed evenly, with all of its reflections. A patch whose
/// hemisphere is covered by others with the share s sends them s of its light, and receives s of the distributed light;
/// patches that face nothing take no part.
Rgb ambient_of(const RadiositySystem& system, const std::vector<Rgb>& unsent) {
    const Spread spread = tree_sum(unsent.size(), [&](uint64_t i) -> Spread {
        const SystemPatch& patch = system.patches[i];
        const std::span<const FormFactor> row = system.row(i);
        const double covered = tree_sum(row.size(), [&](uint64_t k) { return static_cast<double>(row[k].factor); });
        const double size = static_cast<double>(patch.area) * covered;
        const double reflecting = size * covered;
        const Rgb u = unsent[i], r = patch.reflectance;
        return {size,
                reflecting,
                {size * static_cast<double>(u.r), size * static_cast<double>(u.g), size * static_cast<double>(u.b)},
                {reflecting * static_cast<double>(r.r), reflecting * static_cast<double>(r.g),
                 reflecting * static_cast<double>(r.b)}};
    });
    const double area = spread.area;
    if (!(area > 0)) return {};
    const auto of = [&](int k) {
        const double absorbed = std::max(1 - spread.reflected[k] / area, kMinAbsorbed);
        return static_cast<float>(spread.arrives[k] / area / absorbed * (spread.squared / area));
    };
    return {of(0), of(1), of(2)};
}

} // namespace

SolvedSystem solve_by_southwell(const RadiositySystem& system, double tolerance, uint64_t steps,
                                const KeepSolving& keep_going) {
    const std::size_t count = system.patches.size();
    SolvedSystem solved;
    solved.irradiance = system.direct;
    std::vector<Rgb> unsent(count);
    LargestUnsent most(count);
    for (std::size_t i = 0; i < count; ++i) {
        const SystemPatch& patch = system.patches[i];
        unsent[i] = patch.exitance + patch.reflectance * system.direct[i];
        most.set(i, light_of(patch, unsent[i]));
    }
    const auto all_unsent = [&] {
        return tree_sum(count, [&](uint64_t i) { return light_of(system.patches[i], unsent[i]); });
    };
    const double all = all_unsent();
    const auto count_left = [&] { solved.left = all > 0 ? all_unsent() / all : 0; };
    count_left();
    Receivers receivers(system);
    const uint64_t max_steps = steps > 0 ? steps : kMaxSweeps * count;
    uint64_t work = 0; // since the watch was last queried
    bool goes_on = receivers.find(system, keep_going);
    while (goes_on && solved.left > tolerance && solved.steps < max_steps) {
        const std::size_t sender = most.first();
        const Rgb sent = unsent[sender];
        unsent[sender] = {};
        most.set(sender, 0);
        for (const Receiver& receiver : receivers.of(sender)) {
            const Rgb received = receiver.factor * sent;
            const SystemPatch& patch = system.patches[receiver.patch];
            solved.irradiance[receiver.patch] += received;
            unsent[receiver.patch] += patch.reflectance * received;
            most.set(receiver.patch, light_of(patch, unsent[receiver.patch]));
        }
        ++solved.steps;
        work += receivers.of(sender).size() + kMinWork;
        if (work < kMinWork * 256 + count) continue;
        work = 0;
        count_left();
        goes_on = !keep_going || keep_going(solved.left);
    }
    count_left();
    solved.reached_limit = goes_on && steps == 0 && solved.left > tolerance;
    solved.unsent = unsent;
    solved.ambient = ambient_of(system, unsent);
    return solved;
}

} // namespace pertev
