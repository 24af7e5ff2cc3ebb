#include "base/huge_pages.h"

#include <algorithm>
#include <cstdint>

#ifdef __linux__
#include <sys/mman.h>
#endif

namespace pertev {

#ifdef __linux__
namespace {

constexpr std::uintptr_t kHugePage = std::uintptr_t(1) << 21;

/// The whole huge pages within bytes. It is empty if `begin` is not less than `end`.
struct HugePages {
    std::uintptr_t begin, end;

    explicit HugePages(std::span<const std::byte> bytes) {
        const auto first = reinterpret_cast<std::uintptr_t>(bytes.data());
        begin = (first + kHugePage - 1) / kHugePage * kHugePage, end = (first + bytes.size()) / kHugePage * kHugePage;
    }
};

bool advise(std::uintptr_t at, std::size_t size, int advice) {
    return ::madvise(reinterpret_cast<void*>(at), size, advice) == 0; // NOLINT(performance-no-int-to-ptr)
}

} // namespace
#endif

void expect_huge_pages(std::span<const std::byte> bytes) {
#ifdef __linux__
    const HugePages pages(bytes);
    if (pages.begin < pages.end) advise(pages.begin, pages.end - pages.begin, MADV_HUGEPAGE);
#else
    static_cast<void>(bytes);
#endif
}

void use_huge_pages(std::span<const std::byte> bytes, Sink& sink) {
#ifdef __linux__
    constexpr std::uintptr_t kAtOnce = 8 * kHugePage;
    constexpr int kCollapse = 25; // MADV_COLLAPSE, from Linux 6.1 on; earlier kernels refuse it
    const auto [begin, end] = HugePages(bytes);
    if (begin >= end) return;
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
