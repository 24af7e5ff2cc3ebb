#include "base/huge_pages.h"

#include <algorithm>
#include <cstdint>

#ifdef __linux__
#include <sys/mman.h>
#endif

namespace pertev {

void use_huge_pages(std::span<const std::byte> bytes, Sink& sink) {
#ifdef __linux__
    constexpr std::uintptr_t kPage = std::uintptr_t(1) << 21, kAtOnce = 8 * kPage;
    constexpr int kCollapse = 25; // MADV_COLLAPSE, from Linux 6.1 on; earlier kernels refuse it
    const auto first = reinterpret_cast<std::uintptr_t>(bytes.data());
    const std::uintptr_t begin = (first + kPage - 1) / kPage * kPage, end = (first + bytes.size()) / kPage * kPage;
    if (begin >= end) return;
    const auto advise = [](std::uintptr_t at, std::size_t size, int advice) {
        return ::madvise(reinterpret_cast<void*>(at), size, advice) == 0; // NOLINT(performance-no-int-to-ptr)
    };
    bool goes_on = advise(begin, end - begin, MADV_HUGEPAGE);
    for (std::uintptr_t at = begin; goes_on && at < end; at += kAtOnce) {
        sink.check();
        goes_on = advise(at, std::min(kAtOnce, end - at), kCollapse);
    }
#else
    static_cast<void>(sink);
    static_cast<void>(bytes);
#endif
}

} // namespace pertev
