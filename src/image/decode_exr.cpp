#include "image/decode_exr.h"

#include <optional>

#include <fmt/format.h>

#include "base/error.h"
#include "image/exr_reader.h"

namespace pertev {
namespace {

using Channels = std::vector<ExrReader::ChannelInfo>;

// Selects the named channels in this order; nothing if one is missing.
std::optional<Channels> select(const Channels& there, std::initializer_list<const char*> names) {
    Channels result;
    for (const char* name : names) {
        const std::size_t before = result.size();
        for (const ExrReader::ChannelInfo& channel : there) {
            if (channel.name == name) result.push_back(channel);
        }
        if (result.size() == before) return std::nullopt;
    }
    return result;
}

std::optional<Channels> colour_of(const Channels& there) {
    if (select(there, {"Y", "RY"})) return std::nullopt; // Y alone would be the picture without its colour
    for (const auto& names :
         {std::initializer_list<const char*>{"R", "G", "B", "A"}, {"R", "G", "B"}, {"Y", "A"}, {"Y"}})
        if (auto channels = select(there, names)) return channels;
    return std::nullopt;
}

} // namespace

Image decode_exr(std::span<const std::byte> bytes, const std::string& name) {
    ExrReader reader(bytes, name);
    std::string seen;
    for (std::size_t part = 0; part < reader.part_count(); ++part) {
        const Channels there = reader.channels(part);
        const std::optional<Channels> wanted = colour_of(there);
        if (!wanted) {
            for (const ExrReader::ChannelInfo& channel : there) seen += (seen.empty() ? "" : ", ") + channel.name;
            continue;
        }
        const std::vector<ExrChannel> channels = reader.read(part, *wanted, true);
        Image image{reader.width(), reader.height(), static_cast<uint32_t>(channels.size()), {}};
        image.pixels.resize(std::size_t(image.width) * image.height * image.channels);
        for (std::size_t c = 0; c < channels.size(); ++c) {
            const std::vector<float>& from = std::get<0>(channels[c].values);
            for (std::size_t i = 0; i < from.size(); ++i) image.pixels[i * channels.size() + c] = from[i];
        }
        return image;
    }
    throw Error(ErrorCode::BadInput, FileLocation{name},
                fmt::format("no part of this EXR has the channels R, G, B or Y; it has {}", seen));
}

} // namespace pertev
