#pragma once

// Nodes of fuzz_lobe.h, over roughness from kRoughnessMin to 1 and the root of the view's cosine. The numbers are in
// fuzz_table.inl, which tools/make_fuzz_table.py writes.

#include "base/host_device.h"
#include "math/scalar.h"
#include "shading/lobes/energy_tables.h"

namespace pertev::fuzz_table {

inline constexpr int kRoughnessNodes = 16, kMuNodes = 20, kColumns = 4;
inline constexpr float kRoughnessMin = 0.1f;

extern const float values[];

/// Host code reads one array of the program; a GPU has one in each kernel, since device code is not linked.
HD inline float value_at(int i) {
#ifdef __CUDA_ARCH__
    static constexpr float k[] = {
#include "shading/lobes/fuzz_table.inl"
    };
    return k[i];
#else
    return values[i];
#endif
}

/// A transformed cosine: w goes to (scale w.x + shear w.z, scale w.y, w.z), where x is the view's side.
struct Node {
    float scale, shear_by_sine, magnitude;
    float albedo; // the lobe's, rather too much
};

HD_CALL inline Node node_at(float roughness, float mu) {
    const energy_table::Cell row =
        energy_table::make_cell((roughness - kRoughnessMin) * (1.0f / (1.0f - kRoughnessMin)), kRoughnessNodes);
    const energy_table::Cell column = energy_table::make_cell(sqrt(mu), kMuNodes);
    float numbers[kColumns];
    for (int c = 0; c < kColumns; ++c) {
        const int i = (row.node * kMuNodes + column.node) * kColumns + c;
        constexpr int below = kMuNodes * kColumns;
        numbers[c] = lerp(lerp(value_at(i), value_at(i + kColumns), column.fraction),
                          lerp(value_at(i + below), value_at(i + below + kColumns), column.fraction), row.fraction);
    }
    return {numbers[0], numbers[1], numbers[2], numbers[3]};
}

} // namespace pertev::fuzz_table
