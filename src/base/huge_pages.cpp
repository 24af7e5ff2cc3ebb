#include "base/huge_pages.h"

#include <cstdint>

#ifdef __linux__
#include <sys/mman.h>
#endif

namespace pertev {

void use_huge_pages(std::span<const std::byte> bytes) {
#ifdef __linux__
    constexpr std::uintptr_t kPage = std::uintptr_t(1) << 21;
    constexpr int kCollapse = 25; // MADV_COLLAPSE, from Linux 6.1 on; earlier kernels refuse it
    const auto at = reinterpret_cast<std::uintptr_t>(bytes.data());
    const std::uintptr_t begin = (at + kPage - 1) / kPage * kPage, end = (at + bytes.size()) / kPage * kPage;
    if (bytes.empty() || begin >= end) return;
    void* const first = reinterpret_cast<void*>(begin); // NOLINT(performance-no-int-to-ptr)
    if (::madvise(first, end - begin, MADV_HUGEPAGE) == 0) ::madvise(first, end - begin, kCollapse);
#else
    static_cast<void>(bytes);
#endif
}

} // namespace pertev
