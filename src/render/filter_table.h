#pragma once

// What a pixel filter looks up, in a device's memory.

#include "device/buffer.h"
#include "render/pixel_filter.h"

namespace pertev {

/// Room for the table of any filter: another one takes no memory anew.
class FilterTable {
public:
    explicit FilterTable(Queue& queue) : table_(queue, kFilterTableSize + 1, "pixel filter") {}

    /// The view of `filter`; of the one before, it is void.
    PixelFilterView set(PixelFilter filter, float radius) {
        table_.upload(std::span<const float>(make_filter_table(filter)));
        return {filter, radius, table_.data()};
    }

private:
    Buffer<float> table_;
};

} // namespace pertev
