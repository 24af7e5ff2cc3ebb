#include "shading/lobes/fuzz_table.h"

// The host's array of the numbers; device code has its own (fuzz_table.h).

namespace pertev::fuzz_table {

// clang-format off
const float values[] = {
#include "shading/lobes/fuzz_table.inl"
};
// clang-format on

static_assert(sizeof(values) == sizeof(float) * kRoughnessNodes * kMuNodes * kColumns);

} // namespace pertev::fuzz_table
