// A library with the functions of Open Image Denoise that the renderer calls, by their documented signatures, for
// tests: a pixel becomes half of its colour plus a quarter of its albedo and an eighth of its normal. It counts
// objects that were not released and numbers of the last picture that are not finite, keeps the values that were set,
// and fails on request. Images are in the host's memory.

#include <cmath>
#include <cstddef>
#include <map>
#include <string>

namespace {

struct Image {
    char* first = nullptr;
    std::size_t width = 0, height = 0, pixel_bytes = 0, row_bytes = 0;
    float* at(std::size_t x, std::size_t y) const {
        return reinterpret_cast<float*>(first + y * row_bytes + x * pixel_bytes);
    }
};
struct Filter {
    std::map<std::string, Image> images;
    bool is_committed = false;
};

int made = 0, fault = 0, failing_with = 0;
std::string failing;
#if defined(OIDN_IS_OLD)
constexpr int kVersion = 10403;
#else
constexpr int kVersion = 20501;
#endif
std::map<std::string, int> values;

void call(const char* name) {
    if (failing == name && fault == 0) fault = failing_with;
}

} // namespace

extern "C" {

// The test calls these functions.
void stand_in_fail(const char* name, int with) { failing = name, failing_with = with; }
int stand_in_objects() { return made; }
int stand_in_value(const char* name) { return values[name]; }

bool oidnIsCUDADeviceSupported(int) { return false; }
void* oidnNewCUDADevice(const int*, void* const*, int) { return nullptr; }
void* oidnNewDevice(int type) {
    call("oidnNewDevice");
    if (fault != 0 || type != 1) return nullptr;
    ++made;
    return new int();
}
void oidnReleaseDevice(void* device) {
    delete static_cast<int*>(device);
    --made;
}
void oidnSetDeviceBool(void*, const char* name, bool value) { values[name] = value; }
void oidnSetDeviceInt(void*, const char* name, int value) { values[name] = value; }
int oidnGetDeviceInt(void*, const char* name) { return std::string(name) == "version" ? kVersion : 0; }
int oidnGetDeviceError(void*, const char** message) {
    const int found = fault;
    fault = 0;
    *message = found != 0 ? "the stand-in fails" : nullptr;
    return found;
}
void oidnCommitDevice(void*) { call("oidnCommitDevice"); }
#if !defined(OIDN_IS_LACKING)
void* oidnNewFilter(void*, const char* type) {
    call("oidnNewFilter");
    if (fault != 0 || std::string(type) != "RT") return nullptr;
    ++made;
    return new Filter();
}
#endif
void oidnSetSharedFilterImage(void* filter, const char* name, void* memory, int format, std::size_t width,
                              std::size_t height, std::size_t offset, std::size_t pixel_bytes, std::size_t row_bytes) {
    if (format != 3) fault = 2; // three floats
    static_cast<Filter*>(filter)->images[name] = {static_cast<char*>(memory) + offset, width, height, pixel_bytes,
                                                  row_bytes};
}
void oidnSetFilterBool(void*, const char* name, bool value) { values[name] = value; }
void oidnSetFilterInt(void*, const char* name, int value) { values[name] = value; }
void oidnCommitFilter(void* filter) {
    call("oidnCommitFilter");
    static_cast<Filter*>(filter)->is_committed = true;
}
void oidnExecuteFilter(void* filter) {
    call("oidnExecuteFilter");
    Filter& made_of = *static_cast<Filter*>(filter);
    if (!made_of.is_committed) fault = 3;
    if (fault != 0) return;
    const Image output = made_of.images["output"], color = made_of.images["color"];
    values["not_finite"] = 0;
    for (std::size_t y = 0; y < output.height; ++y) {
        for (std::size_t x = 0; x < output.width; ++x) {
            for (int c = 0; c < 3; ++c) {
                output.at(x, y)[c] = 0.5f * color.at(x, y)[c] + 0.25f * made_of.images["albedo"].at(x, y)[c] +
                                     0.125f * made_of.images["normal"].at(x, y)[c];
                values["not_finite"] += !std::isfinite(output.at(x, y)[c]);
            }
        }
    }
}
void oidnReleaseFilter(void* filter) {
    delete static_cast<Filter*>(filter);
    --made;
}

} // extern "C"
