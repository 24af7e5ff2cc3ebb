#include "device/peer_copy.h"

namespace pertev {

std::string_view name_of_path(CopyPath path) {
    switch (path) {
    case CopyPath::Memory:
        return "in memory";
    case CopyPath::NvLink:
        return "by NVLink";
    case CopyPath::Pcie:
        return "by PCIe";
    case CopyPath::Host:
        break;
    }
    return "through the host";
}

CopyPath copy_path(const Queue& from, const Queue& to) {
    if (!from.is_cuda() && !to.is_cuda()) return CopyPath::Memory;
#if defined(PERTEV_HAS_CUDA)
    if (from.is_cuda() && to.is_cuda()) return cuda_copy_path(from.device_index(), to.device_index());
#endif
    return CopyPath::Host;
}

void allow_copies(Queue& to, const Queue& from) {
    const CopyPath path = copy_path(from, to);
    if (path != CopyPath::NvLink && path != CopyPath::Pcie) return;
#if defined(PERTEV_HAS_CUDA)
    allow_copies_between_gpus(to, from.device_index());
#else
    static_cast<void>(to);
#endif
}

void start_copy_between(Queue& to, void* into, Queue& from, const void* source, std::size_t bytes) {
    if (bytes == 0) return;
    if (!from.is_cuda()) {
        to.copy_to_device(into, source, bytes);
    } else if (!to.is_cuda()) {
        from.copy_to_host(into, source, bytes);
    } else {
#if defined(PERTEV_HAS_CUDA)
        copy_between_gpus(to, into, from.device_index(), source, bytes);
#endif
    }
}

void copy_between(Queue& to, void* into, Queue& from, const void* source, std::size_t bytes) {
    if (bytes == 0) return;
    start_copy_between(to, into, from, source, bytes);
    to.wait();
}

} // namespace pertev
