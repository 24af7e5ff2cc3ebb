#include "image/exr_reader.h"

#include <algorithm>
#include <cstring>
#include <exception>
#include <new>
#include <optional>

#include <ImfChannelList.h>
#include <ImfChromaticitiesAttribute.h>
#include <ImfDoubleAttribute.h>
#include <ImfFloatAttribute.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfIO.h>
#include <ImfInputPart.h>
#include <ImfIntAttribute.h>
#include <ImfMultiPartInputFile.h>
#include <ImfStringAttribute.h>
#include <fmt/format.h>

#include "base/error.h"
#include "image/check_exr_header.h"
#include "image/check_image_size.h"

namespace pertev {
namespace {

class MemoryStream : public Imf::IStream {
public:
    MemoryStream(std::span<const std::byte> bytes, const std::string& name)
        : Imf::IStream(name.c_str()), bytes_(bytes) {}

    bool read(char to[], int count) override {
        if (count < 0 || static_cast<uint64_t>(count) > bytes_.size() - offset_)
            throw std::runtime_error("the file is truncated");
        std::memcpy(to, bytes_.data() + offset_, static_cast<std::size_t>(count));
        offset_ += static_cast<std::size_t>(count);
        return offset_ < bytes_.size();
    }
    uint64_t tellg() override { return offset_; }
    void seekg(uint64_t offset) override {
        if (offset > bytes_.size()) throw std::runtime_error("an offset points beyond the end of the file");
        offset_ = static_cast<std::size_t>(offset);
    }

private:
    std::span<const std::byte> bytes_;
    std::size_t offset_ = 0;
};

struct Window {
    int64_t x0, y0, width, height;
};

Window window_of(const Imath::Box2i& box) {
    return {box.min.x, box.min.y, int64_t(box.max.x) - box.min.x + 1, int64_t(box.max.y) - box.min.y + 1};
}

// The part of `from`, laid out over `data`, that lies inside `display`; zero elsewhere.
template <class T>
std::vector<T> place(std::vector<T> from, const Window& data, const Window& display) {
    if (data.x0 == display.x0 && data.y0 == display.y0 && data.width == display.width && data.height == display.height)
        return from;
    std::vector<T> to(static_cast<std::size_t>(display.width * display.height));
    const int64_t x0 = std::max(data.x0, display.x0), x1 = std::min(data.x0 + data.width, display.x0 + display.width);
    const int64_t y0 = std::max(data.y0, display.y0), y1 = std::min(data.y0 + data.height, display.y0 + display.height);
    for (int64_t y = y0; y < y1 && x0 < x1; ++y) {
        const T* source = from.data() + (y - data.y0) * data.width + (x0 - data.x0);
        std::copy(source, source + (x1 - x0), to.data() + (y - display.y0) * display.width + (x0 - display.x0));
    }
    return to;
}

} // namespace

struct ExrReader::State {
    std::string name;
    MemoryStream stream;
    std::optional<Imf::MultiPartInputFile> file;

    State(std::span<const std::byte> bytes, std::string name_of_file)
        : name(std::move(name_of_file)), stream(bytes, name) {}

    [[noreturn]] void fail(const std::exception& error) const {
        throw Error(ErrorCode::BadInput, FileLocation{name}, fmt::format("not a readable EXR ({})", error.what()));
    }
    const Imf::Header& header(std::size_t part) const { return file->header(static_cast<int>(part)); }
};

ExrReader::ExrReader(std::span<const std::byte> bytes, std::string name) {
    check_exr_header(bytes, name);
    state_ = std::make_unique<State>(bytes, std::move(name));
    try {
        // No worker threads, and no repair of a broken chunk table: a truncated file is an error.
        state_->file.emplace(state_->stream, 0, false);
    } catch (const std::bad_alloc&) {
        throw;
    } catch (const std::exception& error) {
        state_->fail(error);
    }
}

ExrReader::~ExrReader() = default;

std::size_t ExrReader::part_count() const { return static_cast<std::size_t>(state_->file->parts()); }

std::string ExrReader::part_name(std::size_t part) const {
    return state_->header(part).hasName() ? state_->header(part).name() : std::string();
}

std::vector<ExrReader::ChannelInfo> ExrReader::channels(std::size_t part) const {
    std::vector<ChannelInfo> result;
    const Imf::ChannelList& list = state_->header(part).channels();
    for (auto it = list.begin(); it != list.end(); ++it) {
        const Imf::Channel& channel = it.channel();
        result.push_back({it.name(), channel.type == Imf::UINT, channel.xSampling != 1 || channel.ySampling != 1});
    }
    return result;
}

uint32_t ExrReader::width() const { return static_cast<uint32_t>(window_of(state_->header(0).displayWindow()).width); }
uint32_t ExrReader::height() const {
    return static_cast<uint32_t>(window_of(state_->header(0).displayWindow()).height);
}

ExrMetadata ExrReader::metadata() const {
    ExrMetadata result;
    const Imf::Header& header = state_->header(0);
    for (auto it = header.begin(); it != header.end(); ++it) {
        const Imf::Attribute* attribute = &it.attribute();
        if (const auto* text = dynamic_cast<const Imf::StringAttribute*>(attribute))
            result.emplace_back(it.name(), text->value());
        else if (const auto* integer = dynamic_cast<const Imf::IntAttribute*>(attribute))
            result.emplace_back(it.name(), integer->value());
        else if (const auto* single = dynamic_cast<const Imf::FloatAttribute*>(attribute))
            result.emplace_back(it.name(), single->value());
        else if (const auto* wide = dynamic_cast<const Imf::DoubleAttribute*>(attribute))
            result.emplace_back(it.name(), wide->value());
    }
    std::sort(result.begin(), result.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
    return result;
}

bool ExrReader::has_primaries() const {
    const Imf::Header& header = state_->header(0);
    return header.find("chromaticities") != header.end();
}

std::optional<ColorPrimaries> ExrReader::primaries() const {
    const auto* attribute = state_->header(0).findTypedAttribute<Imf::ChromaticitiesAttribute>("chromaticities");
    if (attribute == nullptr) return std::nullopt;
    const Imf::Chromaticities& from = attribute->value();
    const auto to = [](const Imath::V2f& c) { return Chromaticity{double(c.x), double(c.y)}; };
    return ColorPrimaries{.red = to(from.red), .green = to(from.green), .blue = to(from.blue), .white = to(from.white)};
}

std::vector<ExrChannel> ExrReader::read(std::size_t part, const std::vector<ChannelInfo>& wanted, bool all_as_float) {
    const Imf::Header& header = state_->header(part);
    const Window data = window_of(header.dataWindow());
    const Window display = window_of(state_->header(0).displayWindow());
    const std::size_t count = static_cast<std::size_t>(data.width) * static_cast<std::size_t>(data.height);

    std::vector<ExrChannel> result;
    Imf::FrameBuffer frame;
    for (const ChannelInfo& channel : wanted) {
        if (channel.is_subsampled)
            throw Error(ErrorCode::BadInput, FileLocation{state_->name},
                        fmt::format("channel {} has fewer samples than pixels (luminance/chroma), which is not "
                                    "supported; save it as R, G, B",
                                    channel.name));
        const bool as_uint = channel.is_uint && !all_as_float;
        ExrChannel& to = result.emplace_back();
        to.name = channel.name;
        char* base;
        if (as_uint)
            base = reinterpret_cast<char*>(to.values.emplace<1>(count).data());
        else
            base = reinterpret_cast<char*>(to.values.emplace<0>(count).data());
        // OpenEXR wants the address that pixel (0, 0) would have, which is usually outside: integers, not pointers.
        const int64_t shift = 4 * (data.y0 * data.width + data.x0);
        // NOLINTNEXTLINE(performance-no-int-to-ptr): the library's interface requires it
        char* origin = reinterpret_cast<char*>(reinterpret_cast<intptr_t>(base) - shift);
        frame.insert(channel.name,
                     Imf::Slice(as_uint ? Imf::UINT : Imf::FLOAT, origin, 4, static_cast<std::size_t>(data.width) * 4));
    }
    try {
        Imf::InputPart input(*state_->file, static_cast<int>(part));
        input.setFrameBuffer(frame);
        input.readPixels(header.dataWindow().min.y, header.dataWindow().max.y);
    } catch (const std::bad_alloc&) {
        throw;
    } catch (const std::exception& error) {
        state_->fail(error);
    }
    for (ExrChannel& channel : result)
        std::visit([&](auto& values) { values = place(std::move(values), data, display); }, channel.values);
    return result;
}

} // namespace pertev
