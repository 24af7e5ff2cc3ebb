// Checks that the radiosity system has a solution. A patch loses light if it absorbs some, if part of its hemisphere
// is open, or if it gathers from a patch that loses light. A set of patches that loses no light has no solution.

#include <fmt/format.h>

#include "base/error.h"
#include "math/tree_sum.h"
#include "radiosity/radiosity_system.h"

namespace pertev {
namespace {

constexpr double kMinLoss = 1e-6; // share of the light that a patch gathers, beyond rounding

/// Number of patches that light of channel `k` reaches and never leaves.
uint64_t count_endless(const RadiositySystem& system, int k) {
    const std::size_t count = system.patches.size();
    std::vector<uint8_t> loses(count, 0), is_lit(count, 0);
    for (std::size_t i = 0; i < count; ++i) {
        bool reached = system.patches[i].area > 0 && channel(system.direct[i], k) > 0;
        const std::span<const FormFactor> row = system.row(i);
        const double kept = tree_sum(row.size(), [&](uint64_t j) {
            const SystemPatch& source = system.patches[row[j].patch];
            reached = reached || channel(source.exitance, k) > 0;
            return static_cast<double>(row[j].factor) * channel(source.reflectance, k);
        });
        loses[i] = kept < 1 - kMinLoss ? 1 : 0;
        is_lit[i] = reached ? 1 : 0;
    }
    for (bool changes = true; changes;) { // repeated as often as light passes from patch to patch
        changes = false;
        const auto spread = [&](std::size_t i) {
            for (const FormFactor& from : system.row(i)) {
                if (!(from.factor > 0) || !(channel(system.patches[from.patch].reflectance, k) > 0)) continue;
                if (loses[i] == 0 && loses[from.patch] != 0) loses[i] = 1, changes = true;
                if (is_lit[i] == 0 && is_lit[from.patch] != 0) is_lit[i] = 1, changes = true;
            }
        };
        for (std::size_t i = 0; i < count; ++i) spread(i);
        for (std::size_t i = count; i-- > 0;) spread(i);
    }
    uint64_t endless = 0;
    for (std::size_t i = 0; i < count; ++i) endless += loses[i] == 0 && is_lit[i] != 0 ? 1 : 0;
    return endless;
}

} // namespace

void check_light_ends(const RadiositySystem& system) {
    float largest = 0;
    for (const SystemPatch& patch : system.patches) largest = max(largest, max_component(patch.reflectance));
    if (static_cast<double>(largest) < 1 - kMinLoss) return;
    for (int k = 0; k < 3; ++k) {
        const uint64_t endless = count_endless(system, k);
        if (endless == 0) continue;
        throw Error(ErrorCode::BadInput, "scene", "",
                    fmt::format("the system has no solution: {} of {} patches reflect all light to each other; lower "
                                "their reflectances below 1, or set `integrator=path`, which follows light up to "
                                "`max_depth`",
                                endless, system.patches.size()));
    }
}

} // namespace pertev
