// The viewer's JPEG encoders (jpeg_encoder.h): a substitute for nvJPEG (tests/stand_in/nvjpeg.cpp) that records its
// calls and fails on request, and libjpeg-turbo.

#include <dlfcn.h>

#include <cstdio>

#include <doctest/doctest.h>

#include "apps/viewer/jpeg_encoder.h"
#include "image/write_jpeg.h"

using namespace pertev;

namespace {

/// A ramp in red and green, 48 in blue.
Rgba8Image ramp(uint32_t width, uint32_t height) {
    Rgba8Image picture = {width, height, {}};
    for (uint32_t y = 0; y < height; ++y) {
        for (uint32_t x = 0; x < width; ++x) {
            for (const uint32_t value : {x, y, 48u, 255u}) picture.pixels.push_back(static_cast<uint8_t>(value));
        }
    }
    return picture;
}

std::string text_of(const std::vector<std::byte>& file) {
    return {reinterpret_cast<const char*>(file.data()), file.size()};
}

/// The substitute and its controls.
struct StandIn {
    const char* const path = PERTEV_NVJPEG_STAND_IN;
    void* library = ::dlopen(path, RTLD_NOW);
    ~StandIn() {
        if (library != nullptr) ::dlclose(library);
    }
    bool is_there() const {
        if (library == nullptr) std::printf("skipped: %s is not there\n", path);
        return library != nullptr;
    }
    void fail(const char* call) { reinterpret_cast<void (*)(const char*)>(::dlsym(library, "stand_in_fail"))(call); }
    int objects() { return reinterpret_cast<int (*)()>(::dlsym(library, "stand_in_objects"))(); }
    std::vector<const char*> names() const { return {"libno-such-thing.so.1", "libz.so.1", path}; }
};

} // namespace

TEST_CASE("nvJPEG is called as declared, with the picture's bytes, and all of its objects are destroyed") {
    StandIn stand_in;
    if (!stand_in.is_there()) return;
    stand_in.fail("");
    Queue queue = Queue::make_cpu();
    {
        JpegEncoder encoder(&queue, stand_in.names());
        CHECK(std::string(encoder.name()) == "nvJPEG");
        CHECK(stand_in.objects() == 3);
        CHECK(text_of(encoder.encode(ramp(5, 3), 80, true)) ==
              "\xff\xd8quality 80 sampling 2 format 5 size 5x3 pitch 15 sums 30 15 720\xff\xd9");
        CHECK(text_of(encoder.encode(ramp(40, 2), 92, false)) ==
              "\xff\xd8quality 92 sampling 0 format 5 size 40x2 pitch 120 sums 1560 40 3840\xff\xd9");
        CHECK(text_of(encoder.encode(ramp(1, 1), 30, true)).find("size 1x1") != std::string::npos);
        CHECK(stand_in.objects() == 3);
    }
    CHECK(stand_in.objects() == 0);
    CHECK(queue.allocated_bytes() == 0);
}

TEST_CASE("if nvJPEG is missing or any call fails, libjpeg-turbo encodes, and nothing leaks") {
    const Rgba8Image picture = ramp(48, 32);
    const std::vector<std::byte> expected = encode_jpeg_strips(picture, 80, true);
    Queue queue = Queue::make_cpu();
    CHECK(JpegEncoder(nullptr).encode(picture, 80, true) == expected);
    const char* const nowhere[] = {"libno-such-thing.so.1", "libz.so.1"}; // the second library lacks the functions
    JpegEncoder without(&queue, nowhere);
    CHECK(std::string(without.name()) == "libjpeg-turbo");
    CHECK(without.encode(picture, 80, true) == expected);
    StandIn stand_in;
    if (!stand_in.is_there()) return;
    for (const char* call : {"nvjpegCreateSimple", "nvjpegEncoderStateCreate", "nvjpegEncoderParamsCreate",
                             "nvjpegEncoderParamsSetQuality", "nvjpegEncoderParamsSetSamplingFactors",
                             "nvjpegEncodeImage", "the length", "the data", "the file"}) {
        CAPTURE(call);
        stand_in.fail(call);
        JpegEncoder encoder(&queue, stand_in.names());
        CHECK(encoder.encode(picture, 80, true) == expected);
        CHECK(std::string(encoder.name()) == "libjpeg-turbo");
        CHECK(stand_in.objects() == 0);
        CHECK(queue.allocated_bytes() == 0);
        stand_in.fail("");
        CHECK(encoder.encode(picture, 80, true) == expected); // the library is not tried again
    }
}
