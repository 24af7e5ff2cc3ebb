#include <doctest/doctest.h>

#include <algorithm>
#include <bit>
#include <cstring>
#include <limits>
#include <vector>

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfIO.h>
#include <ImfMultiPartOutputFile.h>
#include <ImfOutputFile.h>
#include <ImfOutputPart.h>
#include <ImfPartType.h>
#include <ImfTiledOutputFile.h>

#include "base/error.h"
#include "base/limits.h"
#include "image/decode_image.h"
#include "image/picture_hash.h"
#include "image/read_exr.h"
#include "image/write_exr.h"
#include "tests/support/options.h"
#include "tests/support/thrown_error.h"

using namespace pertev;

namespace {

class Stream : public Imf::OStream {
public:
    Stream() : Imf::OStream("test") {}
    void write(const char from[], int count) override {
        bytes.resize(std::max(bytes.size(), offset_ + static_cast<std::size_t>(count)));
        std::memcpy(bytes.data() + offset_, from, static_cast<std::size_t>(count));
        offset_ += static_cast<std::size_t>(count);
    }
    uint64_t tellp() override { return offset_; }
    void seekp(uint64_t offset) override { offset_ = offset; }
    std::vector<std::byte> bytes;

private:
    std::size_t offset_ = 0;
};

// Returns a value that identifies pixel and channel and is exact in half precision.
float value_at(int x, int y, int channel) {
    return static_cast<float>(x + 16 * y) + 0.25f * static_cast<float>(channel);
}

struct Source {
    Imath::Box2i display{{0, 0}, {9, 7}}, data{{0, 0}, {9, 7}};
    std::vector<const char*> names = {"R", "G", "B"};
    Imf::PixelType type = Imf::FLOAT;
    Imf::Compression compression = Imf::ZIP_COMPRESSION;
    bool tiled = false;
    int sampling = 1;
};

// A header, and the pixels of `data` that are written.
struct Prepared {
    Imf::Header header;
    std::vector<std::vector<float>> floats;
    std::vector<std::vector<unsigned>> uints;
    std::vector<std::vector<Imath::half>> halves;
    Imf::FrameBuffer frame;

    explicit Prepared(const Source& from)
        : header(from.display, from.data, 1, {0, 0}, 1, Imf::INCREASING_Y, from.compression) {
        const int width = from.data.max.x - from.data.min.x + 1;
        int index = 0;
        for (const char* name : from.names) {
            header.channels().insert(name, Imf::Channel(from.type, from.sampling, from.sampling));
            auto& f = floats.emplace_back();
            auto& u = uints.emplace_back();
            auto& h = halves.emplace_back();
            for (int y = from.data.min.y; y <= from.data.max.y; ++y) {
                for (int x = from.data.min.x; x <= from.data.max.x; ++x) {
                    f.push_back(value_at(x, y, index));
                    u.push_back(static_cast<unsigned>(std::max(0.0f, f.back())));
                    h.emplace_back(f.back());
                }
            }
            char* base = from.type == Imf::FLOAT  ? reinterpret_cast<char*>(f.data())
                         : from.type == Imf::UINT ? reinterpret_cast<char*>(u.data())
                                                  : reinterpret_cast<char*>(h.data());
            const int size = from.type == Imf::HALF ? 2 : 4;
            const std::ptrdiff_t shift = size * (from.data.min.x + std::ptrdiff_t(from.data.min.y) * width);
            base = reinterpret_cast<char*>(reinterpret_cast<std::intptr_t>(base) - shift);
            frame.insert(name, Imf::Slice(from.type, base, static_cast<std::size_t>(size),
                                          static_cast<std::size_t>(size * width), from.sampling, from.sampling));
            ++index;
        }
    }
};

std::vector<std::byte> make_exr(const Source& from) {
    Prepared prepared(from);
    Stream stream;
    if (from.tiled) {
        prepared.header.setTileDescription(Imf::TileDescription(4, 3, Imf::MIPMAP_LEVELS));
        Imf::TiledOutputFile file(stream, prepared.header, 0);
        file.setFrameBuffer(prepared.frame);
        file.writeTiles(0, file.numXTiles(0) - 1, 0, file.numYTiles(0) - 1, 0);
    } else {
        Imf::OutputFile file(stream, prepared.header, 0);
        file.setFrameBuffer(prepared.frame);
        file.writePixels(from.data.max.y - from.data.min.y + 1);
    }
    return stream.bytes;
}

Image decode(const std::vector<std::byte>& bytes) { return std::get<Image>(decode_image(bytes, "t.exr")); }

void check_values(const Image& image, uint32_t channels) {
    REQUIRE(image.channels == channels);
    for (int y = 0; y < 8; ++y)
        for (int x = 0; x < 10; ++x)
            for (uint32_t c = 0; c < channels; ++c)
                CHECK(image.at(static_cast<uint32_t>(x), static_cast<uint32_t>(y))[c] ==
                      value_at(x, y, static_cast<int>(c)));
}

std::string message_of(const std::vector<std::byte>& bytes) {
    return test::bad_input_message([&] { decode(bytes); });
}

} // namespace

TEST_CASE("EXR colour is read from float and half, scanlines and tiles, with every lossless compression") {
    for (const Imf::PixelType type : {Imf::FLOAT, Imf::HALF}) {
        for (const bool tiled : {false, true}) {
            for (const Imf::Compression compression : {Imf::NO_COMPRESSION, Imf::RLE_COMPRESSION, Imf::ZIPS_COMPRESSION,
                                                       Imf::ZIP_COMPRESSION, Imf::PIZ_COMPRESSION}) {
                CAPTURE(type);
                CAPTURE(tiled);
                CAPTURE(compression);
                check_values(decode(make_exr({.type = type, .compression = compression, .tiled = tiled})), 3);
            }
        }
    }
}

TEST_CASE("an EXR with R, G, B, A has four channels, one with Y has one, and uint colour is read as numbers") {
    check_values(decode(make_exr({.names = {"R", "G", "B", "A"}})), 4);
    check_values(decode(make_exr({.names = {"Y"}})), 1);
    CHECK(decode(make_exr({.type = Imf::UINT})).at(3, 2)[0] == 35);
}

TEST_CASE("an EXR's display window is the picture: 0 outside the data window, and data outside it is cropped") {
    const Image image = decode(make_exr({.data = {{-3, 2}, {5, 12}}}));
    CHECK(image.width == 10);
    CHECK(image.height == 8);
    for (int y = 0; y < 8; ++y)
        for (int x = 0; x < 10; ++x)
            CHECK(image.at(static_cast<uint32_t>(x), static_cast<uint32_t>(y))[1] ==
                  (x <= 5 && y >= 2 ? value_at(x, y, 1) : 0.0f));
    const Image apart = decode(make_exr({.data = {{100, 100}, {101, 101}}}));
    CHECK(apart.pixels == std::vector<float>(240, 0.0f));
}

TEST_CASE("the first part with colour of a multi-part EXR is the picture, and read_exr names all parts") {
    Prepared depth({.names = {"Z"}}), colour({});
    depth.header.setName("depth");
    colour.header.setName("beauty");
    for (Prepared* part : {&depth, &colour}) part->header.setType(Imf::SCANLINEIMAGE);
    Stream stream;
    {
        const Imf::Header headers[] = {depth.header, colour.header};
        Imf::MultiPartOutputFile file(stream, headers, 2, false, 0);
        int index = 0;
        for (Prepared* part : {&depth, &colour}) {
            Imf::OutputPart output(file, index++);
            output.setFrameBuffer(part->frame);
            output.writePixels(8);
        }
    }
    check_values(decode(stream.bytes), 3);
    const ExrFile file = read_exr(stream.bytes, "t.exr");
    REQUIRE(file.channels.size() == 4);
    REQUIRE(file.find("depth.Z") != nullptr);
    CHECK(std::get<0>(file.find("depth.Z")->values)[12] == value_at(2, 1, 0));
    CHECK(file.find("beauty.G") != nullptr);
}

TEST_CASE("an EXR without colour is an error that lists its channels; so is one with subsampled channels") {
    CHECK(message_of(make_exr({.names = {"R", "B", "depth.Z"}})).find("it has B, R, depth.Z") != std::string::npos);
    CHECK(message_of(make_exr({.sampling = 2})) != "no error");
}

TEST_CASE("an EXR that is truncated anywhere is an error that names the file") {
    const std::vector<std::byte> bytes = make_exr({});
    for (std::size_t left = 4; left < bytes.size(); left += 7) {
        const std::string message = message_of({bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(left)});
        CHECK(message.starts_with("t.exr: "));
    }
}

TEST_CASE(
    "a written EXR is read back to the bit with layers, ids over 2^24 and metadata, and has the same bytes each time") {
    const float inf = std::numeric_limits<float>::infinity();
    const Image picture{2, 2, 4, {0, -0.0f, 1e-42f, 1, inf, -inf, 3.0e38f, 0.1f, 1, 2, 3, 4, 5, 6, 7, 8}};
    const std::vector<ExrLayer> layers = {
        {"albedo", {"R", "G", "B"}, std::vector<float>{1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12}},
        {"id", {"instance"}, std::vector<uint32_t>{0, 16777217, 4294967295u, 5}}};
    const ExrMetadata metadata = {
        {"pertev.scene", "cornell-box"}, {"pertev.seed", 7}, {"pertev.seconds", 0.1}, {"pertev.exposure", 0.5f}};
    const std::vector<std::byte> bytes = encode_exr(picture, layers, metadata);
    CHECK(encode_exr(picture, layers, metadata) == bytes);

    const Image back = decode(bytes);
    REQUIRE(back.channels == 4);
    for (std::size_t i = 0; i < picture.pixels.size(); ++i)
        CHECK(std::bit_cast<uint32_t>(back.pixels[i]) == std::bit_cast<uint32_t>(picture.pixels[i]));
    CHECK(picture_hash(back) == picture_hash(picture));

    const std::filesystem::path path = test::scratch_folder() / "p.exr";
    write_exr(path, picture, layers, metadata);
    const ExrFile file = read_exr(path);
    CHECK(file.width == 2);
    CHECK(file.channels.size() == 8);
    REQUIRE(file.find("albedo.G") != nullptr);
    CHECK(std::get<0>(file.find("albedo.G")->values) == std::vector<float>{2, 5, 8, 11});
    REQUIRE(file.find("id.instance") != nullptr);
    CHECK(std::get<1>(file.find("id.instance")->values) == std::vector<uint32_t>{0, 16777217, 4294967295u, 5});
    for (const auto& entry : metadata) CHECK(std::count(file.metadata.begin(), file.metadata.end(), entry) == 1);
}

TEST_CASE("an EXR holds rows of any length, and packs each alone if sixteen exceed 256 MiB") {
    constexpr uint32_t kWidth = kMaxImageSide;
    for (const auto& [layer_count, compression] :
         {std::pair(20u, Imf::ZIP_COMPRESSION), std::pair(21u, Imf::ZIPS_COMPRESSION)}) {
        CAPTURE(layer_count); // 63 channels of 2^18 bytes a row, and 66
        const Image picture{kWidth, 1, 3, std::vector<float>(3 * kWidth, 0.5f)};
        std::vector<ExrLayer> layers;
        for (uint32_t i = 0; i < layer_count; ++i) {
            layers.push_back(
                {"n" + std::to_string(i), {"R", "G", "B"}, std::vector<float>(3 * kWidth, static_cast<float>(i))});
        }
        const std::vector<std::byte> bytes = encode_exr(picture, layers);
        const char name[] = "compression\0compression\0\1\0\0"; // the size 1 gets another 0, which ends the array
        const auto* const first = reinterpret_cast<const char*>(bytes.data());
        const auto* const found = std::search(first, first + bytes.size(), name, name + sizeof name);
        REQUIRE(found != first + bytes.size());
        CHECK(static_cast<int>(found[sizeof name]) == static_cast<int>(compression));
        const ExrFile file = read_exr(bytes, "wide.exr");
        CHECK(file.channels.size() == 3 + 3 * layer_count);
        const ExrChannel* const last = file.find("n" + std::to_string(layer_count - 1) + ".B");
        REQUIRE(last != nullptr);
        CHECK(std::get<0>(last->values) == std::vector<float>(kWidth, static_cast<float>(layer_count - 1)));
    }
}

TEST_CASE("an EXR of thousands of layers is written and read") {
    std::vector<ExrLayer> layers;
    for (int i = 0; i < 1500; ++i) {
        layers.push_back({"n" + std::to_string(i), {"R", "G", "B"}, std::vector<float>(3, static_cast<float>(i))});
    }
    const ExrFile file = read_exr(encode_exr({1, 1, 3, {1, 2, 3}}, layers), "many.exr");
    REQUIRE(file.channels.size() == 4503);
    for (const int i : {0, 700, 1499}) {
        const ExrChannel* const channel = file.find("n" + std::to_string(i) + ".G");
        REQUIRE(channel != nullptr);
        CHECK(std::get<0>(channel->values) == std::vector<float>{static_cast<float>(i)});
    }
}

TEST_CASE("an EXR whose rows would exceed 1 GiB is refused before it is made") {
    check_exr_row(kMaxImageSide, 4096);
    check_exr_row(1u << 14, 16384);
    for (const auto& [width, channels] : {std::pair(kMaxImageSide, 4097u), std::pair((1u << 14) + 1, 16384u)}) {
        const auto error = test::thrown_error([&, w = width, c = channels] { check_exr_row(w, c); });
        REQUIRE((error && error->code() == ErrorCode::OverLimit));
        CHECK(test::says(error, std::to_string(channels - 1))); // the largest possible number
    }
}

TEST_CASE("two layers of one name, and metadata with a reserved name, fail an assertion") {
    const Image picture{1, 1, 3, {1, 2, 3}};
    const ExrLayer layer{"depth", {"Z"}, std::vector<float>{1}};
    CHECK_THROWS_AS(encode_exr(picture, std::vector<ExrLayer>{layer, layer}), std::logic_error);
    CHECK_THROWS_AS(encode_exr(picture, {}, {{"compression", 1}}), std::logic_error);
}

TEST_CASE("an EXR of half colours rounds to the nearest and stays finite, and other layers keep 32 bits") {
    const Image picture = {1, 1, 3, {1e6f, 0.1f, -1e9f}};
    const std::vector<ExrLayer> layers = {{"albedo", {"R", "G", "B"}, std::vector<float>{0.1f, 65519, 2}, true},
                                          {"depth", {"Z"}, std::vector<float>{1e6f + 0.5f}}};
    const ExrFile file = read_exr(encode_exr(picture, layers, {}, {}, ExrColors::Half), "half.exr");
    const auto value = [&](const char* name) { return std::get<0>(file.find(name)->values).front(); };
    CHECK(value("R") == 65504);
    CHECK(value("G") == 0.0999755859375f);
    CHECK(value("B") == -65504);
    CHECK(value("albedo.R") == 0.0999755859375f);
    CHECK(value("albedo.G") == 65504);
    CHECK(value("albedo.B") == 2);
    CHECK(value("depth.Z") == 1e6f + 0.5f);
}

TEST_CASE("an EXR of a part has its data window there, in the whole's display window") {
    const Image part = {2, 3, 1, {1, 2, 3, 4, 5, 6}};
    for (const auto& [x, y] : {std::pair(3u, 1u), {0u, 0u}, {5u, 2u}}) {
        const ExrFile file = read_exr(encode_exr(part, {}, {}, {x, y, 7, 5}), "part.exr");
        REQUIRE(file.width == 7);
        REQUIRE(file.height == 5);
        std::vector<float> whole(35);
        for (uint32_t i = 0; i < 6; ++i) whole[(y + i / 2) * 7 + x + i % 2] = part.pixels[i];
        CHECK(std::get<0>(file.find("Y")->values) == whole);
    }
}
