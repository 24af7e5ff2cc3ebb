#include "denoise/oidn/oidn_filter.h"

#include <fmt/format.h>

#include "base/error.h"
#include "base/parallel_for.h"

namespace pertev {

OidnFilter::OidnFilter(Queue& queue, uint32_t width, uint32_t height, OidnQuality quality, const char* setting)
    : queue_(queue), width_(width), height_(height), pixels_(std::size_t(width) * height),
      images_(queue, 3 * pixels_, "Open Image Denoise") {
    if (queue.is_dry_run()) return;
    library_ = OidnLibrary::find(setting);
    const bool on_cuda = queue.is_cuda() && library_->is_cuda_supported(queue.device_index());
    if (queue.is_cuda() && !on_cuda) host_images_.resize(3 * pixels_);
    make_device(on_cuda);
    make_filter(quality);
    name_ = fmt::format("Open Image Denoise {} on {}, {} quality", library_->version(),
                        on_cuda ? queue.device_name() : "the CPU", quality == OidnQuality::High ? "high" : "fast");
}

void OidnFilter::make_device(bool on_cuda) {
    const OidnLibrary& call = *library_;
    const int index = queue_.device_index();
    void* const stream = queue_.stream();
    void* const device = on_cuda ? call.new_cuda_device(&index, &stream, 1) : call.new_device(OidnLibrary::kCpu);
    if (device == nullptr) check(nullptr);
    device_ = {device, [library = library_](void* made) {
                   if (made != nullptr) library->release_device(made);
               }};
    if (!on_cuda) { // the threads are those of all other work, which may not be pinned
        const UseThreads use(queue_.threads());
        call.set_device_int(device, "numThreads", thread_count());
        call.set_device_bool(device, "setAffinity", false);
    }
    call.commit_device(device);
    check(device);
}

void OidnFilter::make_filter(OidnQuality quality) {
    const OidnLibrary& call = *library_;
    void* const filter = call.new_filter(device_.get(), "RT");
    check(device_.get());
    filter_ = {filter, [library = library_](void* made) {
                   if (made != nullptr) library->release_filter(made);
               }};
    Float4* const images = host_images_.empty() ? images_.data() : host_images_.data();
    const auto set_image = [&](const char* name, Float4* image) {
        call.set_shared_image(filter, name, image, OidnLibrary::kFloat3, width_, height_, 0, sizeof(Float4),
                              sizeof(Float4) * width_);
    };
    set_image("color", images);
    set_image("albedo", images + pixels_);
    set_image("normal", images + 2 * pixels_);
    set_image("output", images);
    call.set_filter_bool(filter, "hdr", true);
    const bool is_high = quality == OidnQuality::High; // guides are means of many samples, and hardly noisy
    call.set_filter_bool(filter, "cleanAux", is_high);
    call.set_filter_int(filter, "quality", is_high ? OidnLibrary::kHighQuality : OidnLibrary::kFastQuality);
    call.commit_filter(filter);
    check(device_.get());
}

void OidnFilter::run() {
    const Queue::Scope scope(queue_, "Open Image Denoise");
    if (!host_images_.empty()) queue_.copy_to_host(host_images_.data(), images_.data(), 3 * pixels_ * sizeof(Float4));
    library_->execute_filter(filter_.get());
    check(device_.get());
    if (!host_images_.empty()) queue_.copy_to_device(images_.data(), host_images_.data(), pixels_ * sizeof(Float4));
}

/// Throws the library's last error; null: that of making a device, which has failed.
void OidnFilter::check(void* device) {
    const char* message = nullptr;
    const int fault = library_->device_error(device, &message);
    if (fault == 0 && device != nullptr) return;
    throw Error(fault == OidnLibrary::kOutOfMemory ? ErrorCode::OutOfMemory : ErrorCode::DeviceFault,
                fmt::format("Open Image Denoise {}: {}", library_->version(),
                            message != nullptr ? message : "it failed without a reason"));
}

} // namespace pertev
