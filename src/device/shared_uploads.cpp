#include "device/shared_uploads.h"

#include "device/peer_copy.h"

namespace pertev {
namespace {

thread_local SharedUploads* remembers = nullptr;
thread_local const SharedUploads* has_them = nullptr;

} // namespace

SharedUploads::Scope::Scope(SharedUploads& to, const SharedUploads* from) {
    remembers = &to;
    has_them = from;
}

SharedUploads::Scope::~Scope() {
    remembers = nullptr;
    has_them = nullptr;
}

/// Copies an array from the device that has it. Returns false if it has not, or if only its own thread can read it.
bool SharedUploads::copy(Queue& to, void* device, std::span<const std::byte> host) const {
    const auto found = uploaded_.find({host.data(), host.size()});
    if (found == uploaded_.end() || to.is_cuda() != queue_->is_cuda()) return false;
    if (to.is_cuda()) {
        start_copy_between(to, device, *queue_, found->second, host.size());
    } else {
        to.copy_on_device(device, found->second, host.size());
    }
    return true;
}

void upload_array(Queue& queue, void* device, std::span<const std::byte> host, bool lasts) {
    const bool is_shared = remembers != nullptr && host.size() >= SharedUploads::kWorthIt && !queue.is_dry_run() &&
                           (lasts || remembers->lasting_.contains(host.data()));
    if (is_shared) remembers->uploaded_[{host.data(), host.size()}] = device;
    if (is_shared && has_them != nullptr && has_them->copy(queue, device, host)) return;
    queue.copy_to_device(device, host.data(), host.size());
}

} // namespace pertev
