#include "formats/gltf/repair_keys.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

namespace pertev::gltf {
namespace {

/// Returns the numbers of the keys that remain when repeated times are removed, in the order of their times.
std::vector<std::size_t> without_repeats(const std::vector<std::size_t>& order, const AnimationChannel& channel) {
    const auto time = [&](std::size_t i) { return channel.times[order[i]]; };
    std::vector<std::size_t> kept;
    for (std::size_t first = 0, end = 0; first < order.size(); first = end) {
        while (end < order.size() && time(end) == time(first)) ++end;
        const std::size_t last = end - 1;
        const bool is_start = first == 0, is_end = end == order.size();
        const bool keeps_last_alone = is_start || channel.interpolation == Interpolation::Step;
        if (!keeps_last_alone) kept.push_back(order[first]);
        if (keeps_last_alone || (last > first && !is_end)) kept.push_back(order[last]);
    }
    return kept;
}

} // namespace

std::string repair_keys(AnimationChannel& channel, std::size_t numbers_a_key) {
    const std::vector<float>& times = channel.times;
    std::vector<std::size_t> order(times.size());
    std::iota(order.begin(), order.end(), std::size_t(0));
    std::erase_if(order, [&](std::size_t i) { return !std::isfinite(times[i]); });
    std::string mended = order.size() < times.size() ? "key times that are not finite are left out" : "";
    const auto is_before = [&](std::size_t a, std::size_t b) { return times[a] < times[b]; };
    if (!std::ranges::is_sorted(order, is_before)) {
        std::ranges::stable_sort(order, is_before);
        mended += mended.empty() ? "" : ", ";
        mended += "keys are sorted by time";
    }
    const std::vector<std::size_t> kept = without_repeats(order, channel);
    if (kept.size() == times.size() && mended.empty()) return mended;
    AnimationChannel result = channel;
    result.times.clear();
    result.values.clear();
    for (const std::size_t key : kept) {
        const auto values = channel.values.begin() + static_cast<std::ptrdiff_t>(key * numbers_a_key);
        result.times.push_back(times[key]);
        result.values.insert(result.values.end(), values, values + static_cast<std::ptrdiff_t>(numbers_a_key));
    }
    channel = std::move(result);
    return mended;
}

} // namespace pertev::gltf
