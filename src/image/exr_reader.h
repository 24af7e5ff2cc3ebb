#pragma once

// An OpenEXR file in memory, the basis of decode_exr and read_exr. Scanline and tiled parts, full resolution only.

#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "image/color_primaries.h"
#include "image/exr_file.h"

namespace pertev {

class ExrReader {
public:
    struct ChannelInfo {
        std::string name;
        bool is_uint = false;
        bool is_subsampled = false;
    };

    /// `bytes` must outlive the reader. Throws Error(BadInput) or Error(OverLimit) that starts with `name`.
    ExrReader(std::span<const std::byte> bytes, std::string name);
    ~ExrReader();
    ExrReader(const ExrReader&) = delete;
    ExrReader& operator=(const ExrReader&) = delete;

    std::size_t part_count() const;
    /// Empty if the file does not name the part.
    std::string part_name(std::size_t part) const;
    std::vector<ChannelInfo> channels(std::size_t part) const; // sorted by name
    uint32_t width() const;                                    // size of the first part's display window
    uint32_t height() const;
    ExrMetadata metadata() const; // header of the first part
    bool has_primaries() const;   // whether the first part's header has the attribute `chromaticities`, which all
                                  // parts share
    std::optional<ColorPrimaries> primaries() const; // nothing also if that attribute has another type

    /// Values of the named channels of a part, in that order, over the display window. Ids (uint) stay integers
    /// unless `all_as_float`. Throws Error(BadInput) for damaged pixels and for a subsampled channel.
    std::vector<ExrChannel> read(std::size_t part, const std::vector<ChannelInfo>& wanted, bool all_as_float);

private:
    struct State;
    std::unique_ptr<State> state_;
};

} // namespace pertev
