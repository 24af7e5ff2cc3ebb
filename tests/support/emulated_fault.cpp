// Describes deadlocks of lanes.

#include <cstdio>
#include <string_view>

#include "tests/support/emulated_lanes.h"

extern "C" const char __executable_start; // defined by the linker; addresses are printed relative to it

namespace pertev::test {
namespace {

constexpr const char* kNames[] = {"__activemask",     "__ballot_sync", "__all_sync",
                                  "__match_any_sync", "__shfl_sync",   "__syncwarp"};

std::string text_of_lanes(uint32_t mask) {
    std::string text;
    for (unsigned k = 0; k < 32; ++k) {
        if ((mask >> k & 1) == 0) continue;
        unsigned last = k;
        while (last < 31 && (mask >> (last + 1) & 1) != 0) ++last;
        text += (text.empty() ? "" : ", ") + std::to_string(k);
        if (last > k) text += "-" + std::to_string(last);
        k = last;
    }
    return text;
}

std::string text_of_location(const std::source_location& at) {
    std::string_view file = at.file_name();
    for (const char* folder : {"/src/", "/tests/"}) {
        const std::size_t from = file.rfind(folder);
        if (from != file.npos) file.remove_prefix(from + 1);
    }
    return std::string(file) + ":" + std::to_string(at.line());
}

std::string text_of_hex(uint64_t value) {
    char text[32];
    std::snprintf(text, sizeof text, "0x%llx", static_cast<unsigned long long>(value));
    return text;
}

std::string describe_calls(const EmulatedLane& lane) {
    std::string text;
    for_each_call(lane, [&](const void* address) {
        text += " " + text_of_hex(static_cast<uint64_t>(static_cast<const char*>(address) - &__executable_start));
    });
    return text;
}

/// Describes the state of lanes that have not reached a warp operation.
std::string describe_missing(const EmulatedWarp& warp, const WarpOperation& operation) {
    uint32_t other_mask = 0, elsewhere = 0;
    for_each_lane(operation.mask & warp.live, [&](unsigned k) {
        const WarpOperation& other = warp.lanes[k].operation;
        const bool waits = ((warp.waiting | warp.pending) >> k & 1) != 0;
        if (waits && other.kind == operation.kind && other.mask == operation.mask) return;
        (waits && other.kind == operation.kind ? other_mask : elsewhere) |= 1u << k;
    });
    std::string text;
    const uint32_t ended = operation.mask & ~warp.live;
    if (ended != 0) text += "; lanes " + text_of_lanes(ended) + " of it have ended";
    if (other_mask != 0) text += "; lanes " + text_of_lanes(other_mask) + " of it name another mask";
    if (elsewhere != 0) text += "; lanes " + text_of_lanes(elsewhere) + " of it are elsewhere";
    return text;
}

} // namespace

std::string describe(const EmulatedWarp& warp) {
    std::string text = "\nblock " + std::to_string(warp.block) + ", threads from " + std::to_string(warp.first_thread);
    const uint32_t at_rest = warp.waiting | warp.pending;
    for (uint32_t left = at_rest; left != 0;) {
        const EmulatedLane& first = warp.lanes[static_cast<unsigned>(__builtin_ctz(left))];
        const WarpOperation& operation = first.operation;
        const std::string calls = describe_calls(first);
        uint32_t same = 0;
        for_each_lane(left, [&](unsigned k) {
            const WarpOperation& other = warp.lanes[k].operation;
            const bool alike = other.kind == operation.kind && other.mask == operation.mask &&
                               text_of_location(other.at) == text_of_location(operation.at) &&
                               describe_calls(warp.lanes[k]) == calls;
            same |= alike ? 1u << k : 0;
        });
        left &= ~same;
        text += "\n  lanes " + text_of_lanes(same) + " wait at " + kNames[static_cast<int>(operation.kind)];
        if (operation.kind != WarpOperationKind::ActiveMask) text += " of mask " + text_of_hex(operation.mask);
        text += ", " + text_of_location(operation.at);
        if (operation.kind != WarpOperationKind::ActiveMask) text += describe_missing(warp, operation);
        text += "\n    addr2line -Cfipe build/bin/pertev_tests" + calls;
    }
    if (warp.live != 0xffffffffu) text += "\n  lanes " + text_of_lanes(~warp.live) + " have ended";
    if ((warp.live & ~at_rest) != 0) text += "\n  lanes " + text_of_lanes(warp.live & ~at_rest) + " could go on";
    return text;
}

} // namespace pertev::test
