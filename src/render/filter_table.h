#pragma once

// What a pixel filter looks up, in a device's memory.

#include <optional>

#include "device/buffer.h"
#include "render/pixel_filter.h"

namespace pertev {

/// Room for the table of any filter: another one takes no memory anew, and one that is there is not copied again.
class FilterTable {
public:
    explicit FilterTable(Queue& queue) : table_(queue, kFilterTableSize + 1, "pixel filter") {}

    /// The view of `filter`; of the one before, it may be void.
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
    std::optional<PixelFilter> held_; // whose table it is
};

} // namespace pertev
