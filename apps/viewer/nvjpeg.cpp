#include "apps/viewer/nvjpeg.h"

#include <dlfcn.h>

#include "base/error.h"
#include "base/parallel_for.h"

namespace pertev {
namespace {

using Status = int; // nvjpegStatus_t: 0 is success

/// Layout of nvjpegImage_t.
struct Channels {
    unsigned char* channel[4];
    std::size_t pitch[4]; // bytes from row to row
};

constexpr int kInterleavedRgb = 5;                           // NVJPEG_INPUT_RGBI
constexpr int kFullChroma = 0, kHalfChroma = 2;              // NVJPEG_CSS_444, NVJPEG_CSS_420
constexpr std::byte kMarker{0xff}, kStart{0xd8}, kEnd{0xd9}; // markers of a JPEG file

constexpr const char* kLibraries[] = {"libnvjpeg.so.13", "libnvjpeg.so.12", "libnvjpeg.so.11",
                                      "/usr/local/cuda/lib64/libnvjpeg.so"};

bool is_whole(const std::vector<std::byte>& file) {
    const std::size_t n = file.size();
    return n > 4 && file[0] == kMarker && file[1] == kStart && file[n - 2] == kMarker && file[n - 1] == kEnd;
}

} // namespace

/// Handles and streams are opaque pointers of the library.
struct Nvjpeg::Functions {
    Status (*create)(void** handle);
    Status (*destroy)(void* handle);
    Status (*create_state)(void* handle, void** state, void* stream);
    Status (*destroy_state)(void* state);
    Status (*create_parameters)(void* handle, void** parameters, void* stream);
    Status (*destroy_parameters)(void* parameters);
    Status (*set_quality)(void* parameters, int quality, void* stream);
    Status (*set_sampling)(void* parameters, int sampling, void* stream);
    Status (*encode)(void* handle, void* state, const void* parameters, const Channels* source, int format, int width,
                     int height, void* stream);
    Status (*retrieve)(void* handle, void* state, unsigned char* data, std::size_t* bytes, void* stream);

    /// Returns false if the library lacks one.
    bool find(void* library) {
        const auto find_one = [&](const char* name, auto& function) {
            function = reinterpret_cast<std::remove_reference_t<decltype(function)>>(::dlsym(library, name));
            return function != nullptr;
        };
        return find_one("nvjpegCreateSimple", create) && find_one("nvjpegDestroy", destroy) &&
               find_one("nvjpegEncoderStateCreate", create_state) &&
               find_one("nvjpegEncoderStateDestroy", destroy_state) &&
               find_one("nvjpegEncoderParamsCreate", create_parameters) &&
               find_one("nvjpegEncoderParamsDestroy", destroy_parameters) &&
               find_one("nvjpegEncoderParamsSetQuality", set_quality) &&
               find_one("nvjpegEncoderParamsSetSamplingFactors", set_sampling) &&
               find_one("nvjpegEncodeImage", encode) && find_one("nvjpegEncodeRetrieveBitstream", retrieve);
    }
};

std::span<const char* const> Nvjpeg::libraries() { return kLibraries; }

std::unique_ptr<Nvjpeg> Nvjpeg::load(Queue& queue, std::span<const char* const> libraries) {
    for (const char* const name : libraries) {
        // It is never unloaded, because its own handlers run when the program ends.
        void* const library = ::dlopen(name, RTLD_NOW | RTLD_LOCAL | RTLD_NODELETE);
        if (library == nullptr) continue;
        auto functions = std::make_unique<Functions>();
        if (!functions->find(library)) {
            ::dlclose(library);
            continue;
        }
        std::unique_ptr<Nvjpeg> made(new Nvjpeg(queue, library, std::move(functions)));
        if (made->begin()) return made;
    }
    return nullptr;
}

Nvjpeg::Nvjpeg(Queue& queue, void* library, std::unique_ptr<Functions> functions)
    : queue_(queue), library_(library), functions_(std::move(functions)) {}

Nvjpeg::~Nvjpeg() {
    try {
        const Queue::Scope scope(queue_, "end of nvJPEG");
        queue_.wait();
    } catch (const Error&) { // the device and all of this is lost
    }
    if (parameters_ != nullptr) functions_->destroy_parameters(parameters_);
    if (state_ != nullptr) functions_->destroy_state(state_);
    if (handle_ != nullptr) functions_->destroy(handle_);
    ::dlclose(library_);
}

bool Nvjpeg::begin() {
    const Queue::Scope scope(queue_, "begin of nvJPEG");
    void* const stream = queue_.stream();
    return functions_->create(&handle_) == 0 && functions_->create_state(handle_, &state_, stream) == 0 &&
           functions_->create_parameters(handle_, &parameters_, stream) == 0;
}

std::vector<std::byte> Nvjpeg::encode(const Rgba8Image& picture, int quality, bool half_chroma) {
    const Queue::Scope scope(queue_, "nvJPEG");
    const std::size_t row_bytes = std::size_t(picture.width) * 3;
    rgb_.resize(row_bytes * picture.height);
    parallel_for(picture.height, 32, [&](uint64_t y) {
        const uint8_t* from = picture.pixels.data() + y * picture.width * 4;
        uint8_t* to = rgb_.data() + y * row_bytes;
        for (uint32_t x = 0; x < picture.width; ++x, from += 4, to += 3)
            to[0] = from[0], to[1] = from[1], to[2] = from[2];
    });
    if (pixels_.size() < rgb_.size()) pixels_ = {queue_, rgb_.size(), "picture to be encoded"};
    pixels_.upload(rgb_);
    const Functions& call = *functions_;
    void* const stream = queue_.stream();
    const Channels source = {{pixels_.data()}, {row_bytes}};
    std::size_t bytes = 0;
    const bool is_packed =
        call.set_quality(parameters_, quality, stream) == 0 &&
        call.set_sampling(parameters_, half_chroma ? kHalfChroma : kFullChroma, stream) == 0 &&
        call.encode(handle_, state_, parameters_, &source, kInterleavedRgb, static_cast<int>(picture.width),
                    static_cast<int>(picture.height), stream) == 0 &&
        call.retrieve(handle_, state_, nullptr, &bytes, stream) == 0;
    queue_.wait();
    if (!is_packed) return {};
    std::vector<std::byte> file(bytes);
    if (call.retrieve(handle_, state_, reinterpret_cast<unsigned char*>(file.data()), &bytes, stream) != 0) return {};
    queue_.wait();
    if (bytes > file.size()) return {};
    file.resize(bytes);
    return is_whole(file) ? file : std::vector<std::byte>();
}

} // namespace pertev
