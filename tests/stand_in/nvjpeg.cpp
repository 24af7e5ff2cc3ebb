// A library for tests with the functions of nvJPEG that the viewer calls, by their documented signatures. It records
// its calls in a file with the markers of a JPEG, counts objects that were not destroyed, and fails on request.
// Pictures are in the host's memory.

#include <cstdio>
#include <cstring>
#include <string>

namespace {

struct Object {
    int kind;
};
struct Parameters {
    Object object;
    int quality, sampling;
};
struct State {
    Object object;
    std::string file;
};
enum Kind { kHandle = 0x11, kState = 0x22, kParameters = 0x33 };
enum Status { kSuccess = 0, kInvalidParameter = 2, kExecutionFailed = 6 };

int made = 0;
std::string failing;

bool fails(const char* name) { return failing == name; }

} // namespace

extern "C" {

typedef struct {
    unsigned char* channel[4];
    size_t pitch[4];
} nvjpegImage_t;

// The test calls these functions.
void stand_in_fail(const char* name) { failing = name; }
int stand_in_objects() { return made; }

int nvjpegCreateSimple(void** handle) {
    if (fails("nvjpegCreateSimple")) return kExecutionFailed;
    *handle = new Object{kHandle};
    ++made;
    return kSuccess;
}

int nvjpegDestroy(void* handle) {
    auto* object = static_cast<Object*>(handle);
    if (object->kind != kHandle) return kInvalidParameter;
    delete object;
    --made;
    return kSuccess;
}

int nvjpegEncoderStateCreate(void* handle, void** state, void*) {
    if (fails("nvjpegEncoderStateCreate") || static_cast<Object*>(handle)->kind != kHandle) return kExecutionFailed;
    *state = new State{{kState}, {}};
    ++made;
    return kSuccess;
}

int nvjpegEncoderStateDestroy(void* state) {
    auto* object = static_cast<State*>(state);
    if (object->object.kind != kState) return kInvalidParameter;
    delete object;
    --made;
    return kSuccess;
}

int nvjpegEncoderParamsCreate(void* handle, void** parameters, void*) {
    if (fails("nvjpegEncoderParamsCreate") || static_cast<Object*>(handle)->kind != kHandle) return kExecutionFailed;
    *parameters = new Parameters{{kParameters}, 70, 0};
    ++made;
    return kSuccess;
}

int nvjpegEncoderParamsDestroy(void* parameters) {
    auto* object = static_cast<Parameters*>(parameters);
    if (object->object.kind != kParameters) return kInvalidParameter;
    delete object;
    --made;
    return kSuccess;
}

int nvjpegEncoderParamsSetQuality(void* parameters, const int quality, void*) {
    auto* object = static_cast<Parameters*>(parameters);
    if (fails("nvjpegEncoderParamsSetQuality") || object->object.kind != kParameters) return kExecutionFailed;
    object->quality = quality;
    return quality >= 1 && quality <= 100 ? kSuccess : kInvalidParameter;
}

int nvjpegEncoderParamsSetSamplingFactors(void* parameters, const int sampling, void*) {
    auto* object = static_cast<Parameters*>(parameters);
    if (fails("nvjpegEncoderParamsSetSamplingFactors") || object->object.kind != kParameters) return kExecutionFailed;
    object->sampling = sampling;
    return kSuccess;
}

int nvjpegEncodeImage(void* handle, void* state, const void* parameters, const nvjpegImage_t* source, int format,
                      int width, int height, void*) {
    const auto* how = static_cast<const Parameters*>(parameters);
    auto* to = static_cast<State*>(state);
    const bool is_sound =
        static_cast<Object*>(handle)->kind == kHandle && to->object.kind == kState && how->object.kind == kParameters;
    if (fails("nvjpegEncodeImage") || !is_sound) return kExecutionFailed;
    unsigned long sums[3] = {};
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            for (int c = 0; c < 3; ++c) {
                sums[c] +=
                    source->channel[0][static_cast<size_t>(y) * source->pitch[0] + static_cast<size_t>(3 * x + c)];
            }
        }
    }
    char text[200];
    std::snprintf(text, sizeof text, "quality %d sampling %d format %d size %dx%d pitch %zu sums %lu %lu %lu",
                  how->quality, how->sampling, format, width, height, source->pitch[0], sums[0], sums[1], sums[2]);
    to->file = std::string("\xff\xd8") + text + (fails("the file") ? "" : "\xff\xd9");
    return kSuccess;
}

int nvjpegEncodeRetrieveBitstream(void* handle, void* state, unsigned char* data, size_t* length, void*) {
    const auto* from = static_cast<const State*>(state);
    if (static_cast<Object*>(handle)->kind != kHandle || from->object.kind != kState) return kInvalidParameter;
    if (fails(data == nullptr ? "the length" : "the data")) return kExecutionFailed;
    if (data == nullptr) {
        *length = from->file.size();
        return kSuccess;
    }
    if (*length < from->file.size()) return kInvalidParameter;
    std::memcpy(data, from->file.data(), from->file.size());
    *length = from->file.size();
    return kSuccess;
}

} // extern "C"
