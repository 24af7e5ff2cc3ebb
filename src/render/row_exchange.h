#pragma once

// Several devices make a frame together, each a band of rows. This is the interface by which one of them takes rows of
// arrays from the devices that made them. All of them run the same code for the same frame, so that each call of one is
// a call of all, with arrays of the same sizes in the same order.

#include <cstddef>
#include <cstdint>
#include <vector>

#include "render/row_band.h"

namespace pertev {

/// An array of a picture's size in a device's memory.
struct RowArray {
    void* data;
    std::size_t row_bytes;
    uint32_t height; // rows
};

class RowExchange {
public:
    virtual ~RowExchange() = default;

    /// Returns the rows that this device makes of a picture of this height. Those of all devices cover it.
    virtual RowBand own_rows(uint32_t height) const = 0;
    /// Takes those of `rows` that others have made, once they have queued that. Work queued here afterwards sees them.
    /// No device may change these rows before the next take() or the end of the frame.
    virtual void take(const std::vector<RowArray>& arrays, RowBand rows) = 0;
    /// Starts collecting the last frame's rows from the devices that rendered them, concurrently with other work.
    virtual void begin_taking_last(const std::vector<RowArray>& arrays) = 0;
    /// Waits for these rows.
    virtual void finish_taking_last() = 0;
    /// Returns whether this is true of any device.
    virtual bool any(bool here) = 0;
};

/// The rows that a device makes of a picture; all of them without others.
inline RowBand own_rows(const RowExchange* others, uint32_t height) {
    return others != nullptr ? others->own_rows(height) : RowBand{0, height};
}

} // namespace pertev
