#include "shading/guided_cdf.h"

#include <algorithm>
#include <bit>

#include "base/error.h"

namespace pertev {
namespace {

constexpr uint32_t kNumberBits = 31;

double usable(double weight) {
    constexpr double largest = 1e300; // so that a sum of 2^30 of them cannot overflow in practice
    return weight > 0 && weight <= largest ? weight : 0.0;
}

} // namespace

uint32_t guide_bits_for(std::size_t count) {
    return static_cast<uint32_t>(std::bit_width(std::max<std::size_t>(count, 1) - 1));
}

double build_guided_cdf(std::span<const double> weights, std::span<uint32_t> starts, std::span<uint32_t> guide) {
    const uint32_t guide_bits = guide_bits_for(weights.size());
    PERTEV_CHECK(starts.size() == weights.size() + 1 && guide.size() == (std::size_t(1) << guide_bits) + 1);
    double total = 0;
    uint64_t positive = 0;
    for (const double weight : weights) {
        total += usable(weight);
        positive += usable(weight) > 0 ? 1 : 0;
    }
    std::ranges::fill(starts, 0u);
    std::ranges::fill(guide, 0u);
    if (!(total > 0)) return 0;

    // One number for every weight above 0, and the rest by weight.
    const double by_weight = static_cast<double>((uint64_t(1) << kNumberBits) - positive);
    double sum = 0;
    uint64_t ones = 0;
    uint32_t last_drawn = 0;
    for (std::size_t i = 0; i < weights.size(); ++i) {
        const double weight = usable(weights[i]);
        if (weight > 0) {
            sum += weight;
            ++ones;
            last_drawn = static_cast<uint32_t>(i);
        }
        starts[i + 1] = static_cast<uint32_t>(ones + static_cast<uint64_t>(sum / total * by_weight)); // at the end: all
    }

    uint32_t index = 0;
    for (std::size_t slot = 0; slot + 1 < guide.size(); ++slot) {
        const uint64_t first = uint64_t(slot) << (kNumberBits - guide_bits);
        while (starts[index + 1] <= first) ++index;
        guide[slot] = index;
    }
    guide.back() = last_drawn;
    return total;
}

GuidedCdf build_guided_cdf(std::span<const double> weights) {
    GuidedCdf table;
    if (weights.empty()) return table;
    table.starts.resize(weights.size() + 1);
    table.guide.resize((std::size_t(1) << guide_bits_for(weights.size())) + 1);
    if (!(build_guided_cdf(weights, table.starts, table.guide) > 0)) table = {};
    return table;
}

GuidedCdfView view_of(const GuidedCdf& table) {
    if (table.starts.empty()) return {};
    const auto count = static_cast<uint32_t>(table.starts.size() - 1);
    return {table.starts.data(), table.guide.data(), count, guide_bits_for(count)};
}

} // namespace pertev
