#include "image/write_exr.h"

#include <algorithm>
#include <cstring>
#include <deque>
#include <type_traits>

#include <ImfChannelList.h>
#include <ImfDoubleAttribute.h>
#include <ImfFloatAttribute.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfIO.h>
#include <ImfIntAttribute.h>
#include <ImfOutputFile.h>
#include <ImfStringAttribute.h>
#include <half.h>

#include <fmt/format.h>

#include "base/error.h"
#include "base/write_file_atomically.h"

namespace pertev {
namespace {

// Grows as it is written to; OpenEXR goes back once to fill in the table of chunks.
class MemoryStream : public Imf::OStream {
public:
    MemoryStream() : Imf::OStream("memory") {}

    void write(const char from[], int count) override {
        const std::size_t end = offset_ + static_cast<std::size_t>(count);
        if (end > bytes.size()) bytes.resize(end);
        std::memcpy(bytes.data() + offset_, from, static_cast<std::size_t>(count));
        offset_ = end;
    }
    uint64_t tellp() override { return offset_; }
    void seekp(uint64_t offset) override { offset_ = static_cast<std::size_t>(offset); }

    std::vector<std::byte> bytes;

private:
    std::size_t offset_ = 0;
};

constexpr std::size_t kMaxChunkBytes = std::size_t(1) << 28; // for 16 rows, which OpenEXR compresses at once
constexpr std::size_t kMaxRowBytes = std::size_t(1) << 30;   // OpenEXR counts them in int

constexpr std::size_t row_bytes(uint32_t width, std::size_t channels) { return sizeof(float) * width * channels; }

Imath::Box2i box_of(uint32_t x, uint32_t y, uint32_t width, uint32_t height) {
    const Imath::V2i corner(static_cast<int>(x), static_cast<int>(y));
    return {corner, corner + Imath::V2i(static_cast<int>(width) - 1, static_cast<int>(height) - 1)};
}

Imf::Header header_of(const Image& picture, const ExrPlace& place) {
    if (place.is_whole()) return {static_cast<int>(picture.width), static_cast<int>(picture.height)};
    return {box_of(0, 0, place.whole_width, place.whole_height),
            box_of(place.x, place.y, picture.width, picture.height)};
}

class Builder {
public:
    Builder(const Image& picture, std::size_t channels, const ExrPlace& place)
        : header(header_of(picture, place)), width_(picture.width), before_(std::size_t{place.y} * width_ + place.x) {
        const uint32_t width = picture.width;
        const bool is_wide = 16 * row_bytes(width, channels) > kMaxChunkBytes;
        header.compression() = is_wide ? Imf::ZIPS_COMPRESSION : Imf::ZIP_COMPRESSION;
    }

    // OpenEXR's slices are of one type for reading and writing; it only reads here.
    void add(const std::string& name, Imf::PixelType type, const void* first, std::size_t stride) {
        PERTEV_CHECK(header.channels().findChannel(name) == nullptr); // two layers of one name
        header.channels().insert(name, Imf::Channel(type));
        // OpenEXR wants the address that pixel (0, 0) of the display would have, which may lie outside.
        const auto base = reinterpret_cast<intptr_t>(first) - static_cast<intptr_t>(stride * before_);
        // NOLINTNEXTLINE(performance-no-int-to-ptr): the library's interface requires it
        frame.insert(name, Imf::Slice(type, reinterpret_cast<char*>(base), stride, stride * width_));
    }

    Imf::Header header;
    Imf::FrameBuffer frame;

private:
    std::size_t width_, before_; // pixels of a row, and from the display's first pixel to the picture's
};

half to_half(float x) { return half(x != x ? x : std::clamp(x, -float(HALF_MAX), float(HALF_MAX))); }

void add_metadata(Imf::Header& header, const ExrMetadata& metadata) {
    for (const auto& [name, value] : metadata) {
        PERTEV_CHECK(!name.empty() && header.find(name) == header.end());
        std::visit(
            [&, &key = name](const auto& v) {
                using T = std::decay_t<decltype(v)>;
                if constexpr (std::is_same_v<T, std::string>)
                    header.insert(key, Imf::StringAttribute(v));
                else
                    header.insert(key, Imf::TypedAttribute<T>(v));
            },
            value);
    }
}

} // namespace

void check_exr_row(uint32_t width, std::size_t channels) {
    if (row_bytes(width, channels) <= kMaxRowBytes) return;
    throw Error(ErrorCode::OverLimit, "size", "",
                fmt::format("{} channels of {} pixels per row exceed an EXR's limit of 1 GiB per row, which are {} "
                            "channels of that width",
                            channels, width, kMaxRowBytes / row_bytes(width, 1)));
}

std::vector<std::byte> encode_exr(const Image& picture, std::span<const ExrLayer> layers, const ExrMetadata& metadata,
                                  const ExrPlace& place, ExrColors colors) {
    const std::size_t pixels = std::size_t(picture.width) * picture.height;
    PERTEV_CHECK(pixels > 0 && picture.channels >= 1 && picture.channels <= 4);
    PERTEV_CHECK(picture.pixels.size() == pixels * picture.channels);

    std::size_t channels = picture.channels;
    for (const ExrLayer& layer : layers) channels += layer.channels.size();
    PERTEV_CHECK(row_bytes(picture.width, channels) <= kMaxRowBytes);
    Builder builder(picture, channels, place);
    std::deque<std::vector<half>> halves; // the file is written from these
    const auto add = [&](const std::string& name, const std::vector<float>& values, std::size_t c, std::size_t count,
                         bool is_color) {
        if (!is_color || colors == ExrColors::Float)
            return builder.add(name, Imf::FLOAT, values.data() + c, count * sizeof(float));
        std::vector<half>& to = halves.emplace_back(pixels);
        for (std::size_t i = 0; i < pixels; ++i) to[i] = to_half(values[i * count + c]);
        builder.add(name, Imf::HALF, to.data(), sizeof(half));
    };
    constexpr const char* kNames[4][4] = {{"Y"}, {"Y", "A"}, {"R", "G", "B"}, {"R", "G", "B", "A"}};
    for (uint32_t c = 0; c < picture.channels; ++c)
        add(kNames[picture.channels - 1][c], picture.pixels, c, picture.channels, true);

    for (const ExrLayer& layer : layers) {
        const std::size_t count = layer.channels.size();
        std::visit(
            [&](const auto& values) {
                PERTEV_CHECK(values.size() == pixels * count);
                for (std::size_t c = 0; c < count; ++c) {
                    const std::string name = layer.name + "." + layer.channels[c];
                    if constexpr (std::is_same_v<std::decay_t<decltype(values)>, std::vector<float>>)
                        add(name, values, c, count, layer.is_color);
                    else
                        builder.add(name, Imf::UINT, values.data() + c, count * sizeof(uint32_t));
                }
            },
            layer.values);
    }
    add_metadata(builder.header, metadata);

    MemoryStream stream;
    {
        Imf::OutputFile file(stream, builder.header, 0);
        file.setFrameBuffer(builder.frame);
        file.writePixels(static_cast<int>(picture.height));
    } // the table of chunks is written by the destructor
    return std::move(stream.bytes);
}

void write_exr(const std::filesystem::path& path, const Image& picture, std::span<const ExrLayer> layers,
               const ExrMetadata& metadata, const ExrPlace& place, ExrColors colors) {
    write_file_atomically(path, encode_exr(picture, layers, metadata, place, colors));
}

} // namespace pertev
