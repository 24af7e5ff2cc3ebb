#include "radiosity/form_factor_row.h"

#include <algorithm>

namespace pertev {

void FormFactorRow::sort() {
    // Stable: factors of one patch are added in the order in which they were found.
    std::ranges::stable_sort(factors, {}, &FormFactor::patch);
    std::size_t count = 0;
    for (const FormFactor& next : factors) {
        if (count > 0 && factors[count - 1].patch == next.patch) {
            factors[count - 1].factor += next.factor;
        } else {
            factors[count++] = next;
        }
    }
    factors.resize(count);
}

} // namespace pertev
