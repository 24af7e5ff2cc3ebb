#include "session/film_file/generations.h"

#include <filesystem>
#include <optional>

#include <fmt/format.h>

#include "base/error.h"
#include "base/machine_memory.h"
#include "base/write_file_atomically.h"

namespace pertev {

namespace fs = std::filesystem;

bool has_generation(const std::string& file) {
    std::error_code fault;
    return fs::exists(file, fault) && !fault;
}

void check_space_for_generations(const std::string& file, uint64_t bytes) {
    std::error_code unknown;
    const std::optional<uint64_t> known = free_disk_bytes(fs::weakly_canonical(file, unknown));
    if (!known) return;
    uint64_t free = *known;
    for (const std::string& generation : {file, previous_generation(file)}) {
        const uint64_t size = fs::file_size(generation, unknown);
        if (!unknown) free += size;
    }
    const uint64_t needed = 3 * bytes;
    if (free >= needed) return;
    throw Error(ErrorCode::FileWrite, FileLocation{file},
                fmt::format("two generations of this checkpoint and a third while it is written may take {:.1f} MiB; "
                            "the disk has {:.1f} MiB free",
                            mebibytes(needed), mebibytes(free)));
}

} // namespace pertev
