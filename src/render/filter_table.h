#pragma once

// The lookup table of a pixel filter in device memory.

#include <optional>

#include "device/buffer.h"
#include "render/pixel_filter.h"

namespace pertev {

/// Memory for the table of any filter. A change of filter does not allocate, and a table that is already there is not
/// copied again.
class FilterTable {
public:
    explicit FilterTable(Queue& queue) : table_(queue, kFilterTableSize + 1, "pixel filter") {}

    /// Copies the table of `filter` if needed and returns its view. The previous view becomes invalid.
    PixelFilterView set(PixelFilter filter, float radius) {
        if (filter != held_) {
            const std::vector<float> table = make_filter_table(filter);
            table_.upload(table);
            if (!table.empty()) held_ = filter;
        }
        return {filter, radius, table_.data()};
    }

private:
    Buffer<float> table_;
    std::optional<PixelFilter> held_; // the filter whose table is stored
};

} // namespace pertev
