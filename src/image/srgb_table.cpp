#include "image/srgb_table.h"

#include "image/srgb.h"

namespace pertev {

const std::array<float, 256>& srgb_decode_table() {
    static const std::array<float, 256> table = [] {
        std::array<float, 256> values{};
        for (std::size_t i = 0; i < values.size(); ++i) values[i] = srgb_decode(static_cast<float>(i) / 255.0f);
        return values;
    }();
    return table;
}

} // namespace pertev
