#include "formats/files/included_files.h"

#include <fmt/format.h>

namespace pertev {

void IncludedFiles::count(const std::filesystem::path& file, bool is_nested, const FileLocation& location) {
    constexpr std::size_t kMost = 4096;
    if (known_.insert(file).second || !is_nested || ++repeated_ <= kMost) return;
    throw Error(ErrorCode::OverLimit, location, fmt::format("the same files are included more than {} times", kMost));
}

} // namespace pertev
