#include "image/check_exr_header.h"

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <optional>
#include <string_view>

#include <fmt/format.h>

#include "base/error.h"
#include "image/check_image_size.h"
#include "math/scalar.h"

namespace pertev {
namespace {

// Version word: 8 bits of version, then flags.
constexpr uint32_t kTiled = 0x200, kDeep = 0x800, kMultiPart = 0x1000;
constexpr uint32_t kKnownFlags = kTiled | 0x400 /* long names */ | kDeep | kMultiPart;
constexpr uint8_t kDwaa = 8, kDwab = 9;
constexpr std::size_t kMaxParts = 1024;
constexpr std::size_t kMaxChannels = std::size_t(1) << 20;

struct Box {
    int64_t x0 = 0, y0 = 0, x1 = -1, y1 = -1; // inclusive
    uint64_t width() const { return static_cast<uint64_t>(std::max<int64_t>(x1 - x0 + 1, 0)); }
    uint64_t height() const { return static_cast<uint64_t>(std::max<int64_t>(y1 - y0 + 1, 0)); }
};

struct PartHeader {
    std::optional<Box> data, display;
    std::optional<uint8_t> compression;
    uint64_t channels = 0;
    uint64_t bytes_per_pixel = 0;
    bool is_tiled = false;
    uint32_t tile_width = 0, tile_height = 0;
    bool is_deep = false;
};

class HeaderScan {
public:
    HeaderScan(std::span<const std::byte> bytes, const std::string& name) : bytes_(bytes), name_(name) {}

    ImageHeader run() {
        need(8);
        const uint32_t version = read<uint32_t>(4);
        offset_ = 8;
        if ((version & 0xff) != 2 || ((version & ~0xffu) & ~kKnownFlags) != 0)
            fail(fmt::format("version word {:#x}; version 2 is supported", version));
        ImageHeader result{.width = 0, .height = 0, .is_float = true};
        const bool is_multi_part = (version & kMultiPart) != 0;
        for (std::size_t part = 0;; ++part) {
            if (is_multi_part && peek_is_end()) {
                if (part == 0) fail("the file has no parts");
                break;
            }
            if (part >= kMaxParts) fail(fmt::format("more than {} parts", kMaxParts));
            PartHeader header;
            header.is_tiled = !is_multi_part && (version & kTiled) != 0;
            header.is_deep = !is_multi_part && (version & kDeep) != 0;
            read_part(header);
            check_part(header);
            if (part == 0) {
                result.width = static_cast<uint32_t>(header.display->width());
                result.height = static_cast<uint32_t>(header.display->height());
            }
            if (!is_multi_part) break;
        }
        return result;
    }

private:
    [[noreturn]] void fail(const std::string& what) const {
        throw Error(ErrorCode::BadInput, FileLocation{name_},
                    fmt::format("not a readable EXR (header, byte {}: {})", offset_, what));
    }
    void need(uint64_t count) const {
        if (count > bytes_.size() - offset_) fail("the header is truncated");
    }
    template <class T>
    T read(std::size_t at) const { // the caller has checked that it is there
        T value;
        std::memcpy(&value, bytes_.data() + at, sizeof value);
        return value;
    }
    bool peek_is_end() const {
        need(1);
        return bytes_[offset_] == std::byte{0};
    }
    // A zero-terminated name of at most 255 characters, which ends before `end`.
    std::string_view read_name(std::size_t end) {
        const char* start = reinterpret_cast<const char*>(bytes_.data()) + offset_;
        const void* zero = std::memchr(start, 0, std::min<std::size_t>(end - offset_, 256));
        if (zero == nullptr) fail("a name has no end");
        const std::string_view text(start, static_cast<std::size_t>(static_cast<const char*>(zero) - start));
        offset_ += text.size() + 1;
        return text;
    }

    void read_part(PartHeader& header) {
        while (!peek_is_end()) {
            const std::string_view attribute = read_name(bytes_.size());
            const std::string_view type = read_name(bytes_.size());
            need(4);
            const int64_t size = read<int32_t>(offset_);
            offset_ += 4;
            if (size < 0 || static_cast<uint64_t>(size) > bytes_.size() - offset_)
                fail(fmt::format("attribute \"{}\" claims {} bytes", attribute, size));
            const std::size_t end = offset_ + static_cast<std::size_t>(size);
            read_attribute(header, attribute, type, end);
            offset_ = end;
        }
        ++offset_;
    }

    void read_attribute(PartHeader& header, std::string_view attribute, std::string_view type, std::size_t end) {
        const std::size_t size = end - offset_;
        const auto expect = [&](std::string_view wanted_type, std::size_t wanted_size) {
            if (type != wanted_type || size != wanted_size)
                fail(fmt::format("attribute \"{}\" must be a {} of {} bytes", attribute, wanted_type, wanted_size));
        };
        if (attribute == "dataWindow" || attribute == "displayWindow") {
            expect("box2i", 16);
            const Box box = {read<int32_t>(offset_), read<int32_t>(offset_ + 4), read<int32_t>(offset_ + 8),
                             read<int32_t>(offset_ + 12)};
            (attribute == "dataWindow" ? header.data : header.display) = box;
        } else if (attribute == "compression") {
            expect("compression", 1);
            header.compression = read<uint8_t>(offset_);
            if (*header.compression > kDwab) fail(fmt::format("unknown compression {}", *header.compression));
        } else if (attribute == "tiles") {
            expect("tiledesc", 9);
            header.tile_width = read<uint32_t>(offset_);
            header.tile_height = read<uint32_t>(offset_ + 4);
        } else if (attribute == "channels") {
            if (type != "chlist") fail("attribute \"channels\" must be a chlist");
            read_channels(header, end);
        } else if (attribute == "type") {
            const std::string_view kind(reinterpret_cast<const char*>(bytes_.data()) + offset_, size);
            header.is_tiled = kind == "tiledimage";
            header.is_deep = kind.starts_with("deep");
        }
    }

    void read_channels(PartHeader& header, std::size_t end) {
        header.channels = header.bytes_per_pixel = 0;
        while (true) {
            if (offset_ >= end) fail("the list of channels has no end");
            const std::string_view channel = read_name(end);
            if (channel.empty()) return;
            if (end - offset_ < 16) fail("the list of channels is truncated");
            const int32_t type = read<int32_t>(offset_);
            const int32_t x_sampling = read<int32_t>(offset_ + 8), y_sampling = read<int32_t>(offset_ + 12);
            if (type < 0 || type > 2) fail(fmt::format("channel \"{}\" has the unknown pixel type {}", channel, type));
            if (x_sampling < 1 || y_sampling < 1)
                fail(fmt::format("channel \"{}\" is sampled every {} x {} pixels", channel, x_sampling, y_sampling));
            if (++header.channels > kMaxChannels) fail(fmt::format("more than {} channels", kMaxChannels));
            header.bytes_per_pixel += type == 1 ? 2 : 4;
            offset_ += 16;
        }
    }

    void check_part(const PartHeader& header) {
        if (header.is_deep)
            fail("the file contains deep samples, which are not supported; flatten it to an ordinary EXR");
        if (!header.data || !header.display || !header.compression || header.channels == 0)
            fail("a part lacks its channels, compression, dataWindow or displayWindow");
        const uint64_t decoded_per_pixel = header.channels * sizeof(float); // half becomes float
        const uint64_t most = max_per_byte(*header.compression) * decoded_per_pixel / header.bytes_per_pixel;
        const auto check_size = [&](uint64_t width, uint64_t height) {
            const uint64_t bytes = multiply_saturated(multiply_saturated(width, height), decoded_per_pixel);
            check_image_size(name_, width, height, bytes, bytes_.size(), most);
            return bytes;
        };
        decoded_bytes_ += max(check_size(header.data->width(), header.data->height()),
                              check_size(header.display->width(), header.display->height()));
        check_decoded_bytes(name_, decoded_bytes_, bytes_.size()); // total of all parts
        uint64_t chunks =
            (header.data->height() + rows_per_chunk(*header.compression) - 1) / rows_per_chunk(*header.compression);
        if (header.is_tiled) {
            if (header.tile_width == 0 || header.tile_height == 0) fail("the tiles have no size");
            check_size(header.tile_width, header.tile_height);
            chunks = ((header.data->width() + header.tile_width - 1) / header.tile_width) *
                     ((header.data->height() + header.tile_height - 1) / header.tile_height);
        }
        if (chunks > (bytes_.size() - offset_) / 8)
            fail(fmt::format("{} chunks of pixels do not fit into the file; it is truncated", chunks));
    }

    // Maximum expansion of pixels: deflate reaches 1032:1; DWA stores one number for a block of 64 pixels and
    // deflates that (a black picture of 3840 x 2160: 11200:1).
    static uint64_t max_per_byte(uint8_t compression) {
        return compression == kDwaa || compression == kDwab ? 20000 : 2000;
    }
    static uint64_t rows_per_chunk(uint8_t compression) {
        constexpr uint64_t rows[] = {1, 1, 1, 16, 32, 16, 32, 32, 32, 256};
        return rows[compression];
    }

    std::span<const std::byte> bytes_;
    const std::string& name_;
    std::size_t offset_ = 0;
    uint64_t decoded_bytes_ = 0; // sum of the parts so far
};

} // namespace

ImageHeader check_exr_header(std::span<const std::byte> bytes, const std::string& name) {
    return HeaderScan(bytes, name).run();
}

} // namespace pertev
