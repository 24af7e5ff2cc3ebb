// libFuzzer's functions for the target that the environment variable PERTEV_FUZZ_TARGET names.

#include <cstdio>
#include <cstdlib>
#include <string_view>

#include "tests/fuzz/fuzz_target.h"

namespace {

const pertev::FuzzTarget* g_target = nullptr;

} // namespace

extern "C" int LLVMFuzzerInitialize(int*, char***) {
    const char* const name = std::getenv("PERTEV_FUZZ_TARGET");
    for (const pertev::FuzzTarget& target : pertev::fuzz_targets()) {
        if (name != nullptr && std::string_view(name) == target.name) g_target = &target;
    }
    if (g_target != nullptr) return 0;
    for (const pertev::FuzzTarget& target : pertev::fuzz_targets()) std::puts(target.name);
    std::exit(name == nullptr ? 0 : 2);
}

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, std::size_t size) {
    g_target->read({reinterpret_cast<const std::byte*>(data), size});
    return 0;
}
