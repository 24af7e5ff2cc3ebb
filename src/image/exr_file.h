#pragma once

// Contents of an OpenEXR file: named channels (layers are written `albedo.R`) and metadata.

#include <cstdint>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace pertev {

/// Names and values in the header, for example {"pertev.seed", 7}.
using ExrMetadata = std::vector<std::pair<std::string, std::variant<std::string, int32_t, float, double>>>;

struct ExrChannel {
    std::string name; // "R", "albedo.R", "id.instance"; prefixed with its part's name if a file has several parts
    std::variant<std::vector<float>, std::vector<uint32_t>> values; // [height * width]; half is widened to float
};

struct ExrFile {
    uint32_t width = 0, height = 0; // size of the display window; channels are 0 where the file has no data
    std::vector<ExrChannel> channels;
    ExrMetadata metadata; // text and numbers of the first part's header, sorted by name

    /// The channel with this name, or null.
    const ExrChannel* find(const std::string& name) const {
        for (const ExrChannel& channel : channels) {
            if (channel.name == name) return &channel;
        }
        return nullptr;
    }
};

} // namespace pertev
