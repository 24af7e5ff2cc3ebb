#include "session/film_file/generations.h"

#include <filesystem>

#include <fmt/format.h>

#include "base/machine_memory.h"
#include "base/remove_leftovers.h"
#include "base/write_file_atomically.h"

namespace pertev {
namespace {

namespace fs = std::filesystem;

bool is_there(const std::string& file) {
    std::error_code fault;
    return fs::exists(file, fault) && !fault;
}

/// Returns why the file is damaged, or nothing.
std::optional<Error> damage_of(const std::string& file, const std::function<void(const std::string&)>& take) {
    try {
        take(file);
    } catch (const RefusedGeneration&) {
        throw;
    } catch (const Error& error) {
        if (error.code() != ErrorCode::BadInput && error.code() != ErrorCode::OverLimit) throw;
        return error;
    }
    return std::nullopt;
}

} // namespace

std::optional<Error> Generations::take(const std::function<void(const std::string&)>& take, Sink& sink) {
    remove_leftovers(file_);
    const bool has_previous = is_there(previous_);
    if (!is_there(file_)) {
        if (has_previous) {
            sink.warn({FileLocation{previous_}, "the render does not resume from it, because its checkpoint is "
                                                "missing; rename it to the checkpoint to resume"});
        }
        return std::nullopt;
    }
    const std::optional<Error> damage = damage_of(file_, take);
    is_damaged_ = damage.has_value();
    if (!damage || !has_previous) return damage;
    const std::optional<Error> also = damage_of(previous_, take);
    if (!also) {
        sink.warn(damage->remark().and_then(fmt::format("; the previous generation, {}, is used", previous_)));
        return std::nullopt;
    }
    return Error(damage->code(),
                 damage->remark().and_then(
                     fmt::format("; the previous generation, {}, is not whole either: {}", previous_, also->reason())));
}

void Generations::check_space(uint64_t bytes) const {
    std::error_code unknown;
    const std::optional<uint64_t> known = free_disk_bytes(fs::weakly_canonical(file_, unknown));
    if (!known) return;
    uint64_t free = *known;
    for (const std::string& generation : {file_, previous_}) {
        const uint64_t size = fs::file_size(generation, unknown);
        if (!unknown) free += size;
    }
    const uint64_t needed = 3 * bytes;
    if (free >= needed) return;
    throw Error(ErrorCode::FileWrite, FileLocation{file_},
                fmt::format("two generations of this checkpoint and a third while it is written may take {:.1f} MiB; "
                            "the disk has {:.1f} MiB free",
                            mebibytes(needed), mebibytes(free)));
}

void Generations::write(std::span<const std::byte> bytes) {
    if (is_damaged_)
        write_file_atomically(file_, bytes);
    else
        write_generation(file_, previous_, bytes);
    is_damaged_ = false;
}

void Generations::remove() const {
    std::error_code ignored;
    for (const std::string& generation : {file_, previous_}) fs::remove(generation, ignored);
}

} // namespace pertev
