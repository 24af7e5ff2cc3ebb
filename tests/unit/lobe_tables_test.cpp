#include <doctest/doctest.h>

#include "base/hash.h"
#include "shading/lobes/energy_tables.h"
#include "shading/lobes/sheen_lobe.h"

using namespace pertev;

TEST_CASE("the build reproduces the recorded tables of lobes") {
    Hasher hasher;
    const auto add = [&](int count, auto table) {
        for (int i = 0; i < count; ++i) hasher.add_value(table(i));
    };
    constexpr int kRows = energy_table::kRoughnessNodes * energy_table::kMuNodes,
                  kAverages = energy_table::kAverageNodes;
    add(kRows, energy_table::metal_lost_at);
    add(kRows, energy_table::metal_schlick_at);
    add(kAverages, energy_table::metal_average_lost_at);
    add(kAverages, energy_table::metal_average_schlick_at);
    add(2 * energy_table::kIorNodes * kRows, energy_table::glass_lost_at);
    add(2 * energy_table::kIorNodes * kAverages, energy_table::glass_average_lost_at);
    add(sheen_table::kRoughnessNodes * sheen_table::kMuNodes, sheen_table::albedo_at);
    CHECK(hasher.result().hex() == "dd4f3d285e699efd0e2d08b6bc95da0b");
}
