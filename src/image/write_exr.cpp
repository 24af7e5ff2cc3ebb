#include "image/write_exr.h"

#include <algorithm>
#include <cstring>
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

class Builder {
public:
    Builder(uint32_t width, uint32_t height, std::size_t channels)
        : header(static_cast<int>(width), static_cast<int>(height)), width_(width) {
        const bool is_wide = 16 * row_bytes(width, channels) > kMaxChunkBytes;
        header.compression() = is_wide ? Imf::ZIPS_COMPRESSION : Imf::ZIP_COMPRESSION;
    }

    // OpenEXR's slices are of one type for reading and writing; it only reads here.
    void add(const std::string& name, Imf::PixelType type, const void* first, std::size_t stride) {
        PERTEV_CHECK(header.channels().findChannel(name) == nullptr); // two layers of one name
        header.channels().insert(name, Imf::Channel(type));
        char* base = const_cast<char*>(static_cast<const char*>(first));
        frame.insert(name, Imf::Slice(type, base, stride, stride * width_));
    }

    Imf::Header header;
    Imf::FrameBuffer frame;

private:
    std::size_t width_;
};

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

std::vector<std::byte> encode_exr(const Image& picture, std::span<const ExrLayer> layers, const ExrMetadata& metadata) {
    const std::size_t pixels = std::size_t(picture.width) * picture.height;
    PERTEV_CHECK(pixels > 0 && picture.channels >= 1 && picture.channels <= 4);
    PERTEV_CHECK(picture.pixels.size() == pixels * picture.channels);

    std::size_t channels = picture.channels;
    for (const ExrLayer& layer : layers) channels += layer.channels.size();
    PERTEV_CHECK(row_bytes(picture.width, channels) <= kMaxRowBytes);
    Builder builder(picture.width, picture.height, channels);
    constexpr const char* kNames[4][4] = {{"Y"}, {"Y", "A"}, {"R", "G", "B"}, {"R", "G", "B", "A"}};
    for (uint32_t c = 0; c < picture.channels; ++c)
        builder.add(kNames[picture.channels - 1][c], Imf::FLOAT, picture.pixels.data() + c, picture.channels * 4);

    for (const ExrLayer& layer : layers) {
        const std::size_t count = layer.channels.size();
        std::visit(
            [&](const auto& values) {
                PERTEV_CHECK(values.size() == pixels * count);
                const Imf::PixelType type = layer.values.index() == 0 ? Imf::FLOAT : Imf::UINT;
                for (std::size_t c = 0; c < count; ++c)
                    builder.add(layer.name + "." + layer.channels[c], type, values.data() + c, count * 4);
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
               const ExrMetadata& metadata) {
    write_file_atomically(path, encode_exr(picture, layers, metadata));
}

} // namespace pertev
