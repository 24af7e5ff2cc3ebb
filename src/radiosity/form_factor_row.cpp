#include "radiosity/form_factor_row.h"

#include <algorithm>

#include "math/tree_sum.h"

namespace pertev {
namespace {

struct RowLight {
    double r = 0, g = 0, b = 0;
};

RowLight operator+(RowLight x, RowLight y) { return {x.r + y.r, x.g + y.g, x.b + y.b}; }

} // namespace

void FormFactorRow::sort() {
    // Stable: factors of one patch are added in the order in which they were found.
    std::ranges::stable_sort(factors, {}, &FormFactor::patch);
    std::size_t count = 0;
    for (std::size_t first = 0, last = 0; first < factors.size(); first = last) {
        while (last < factors.size() && factors[last].patch == factors[first].patch) ++last;
        const float sum = tree_sum(last - first, [&](uint64_t i) { return factors[first + i].factor; });
        factors[count++] = {factors[first].patch, sum};
    }
    factors.resize(count);
}

Rgb gather(std::span<const FormFactor> row, const std::vector<Rgb>& radiosity) {
    const RowLight light = tree_sum(row.size(), [&](uint64_t i) {
        const auto factor = static_cast<double>(row[i].factor);
        const Rgb sent = radiosity[row[i].patch];
        return RowLight{factor * static_cast<double>(sent.r), factor * static_cast<double>(sent.g),
                        factor * static_cast<double>(sent.b)};
    });
    return {static_cast<float>(light.r), static_cast<float>(light.g), static_cast<float>(light.b)};
}

} // namespace pertev
