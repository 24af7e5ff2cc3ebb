#pragma once

// Inputs of fuzz targets that are taken for files of packed blocks (session/film_file/block_file.h).

#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "base/hash.h"
#include "device/queue.h"
#include "session/film_file/block_file.h"

namespace pertev {

using Bytes = std::vector<std::byte>;

inline constexpr std::size_t kHashBytes = 16, kBeforeJson = 16;

template <class T>
T value_at(const Bytes& bytes, std::size_t at) {
    T value;
    std::memcpy(&value, &bytes[at], sizeof value);
    return value;
}

template <class T>
void put(T value, std::size_t at, Bytes& bytes) {
    std::memcpy(&bytes[at], &value, sizeof value);
}

/// Puts the hash of the bytes [first, at) there, and adds it to those of the whole file.
inline void put_hash(std::size_t first, std::size_t at, Hasher& all, Bytes& bytes) {
    Hasher hasher;
    hasher.add(std::span<const std::byte>(bytes).subspan(first, at - first));
    const Hash128 hash = hasher.result();
    put(hash.low, at, bytes), put(hash.high, at + 8, bytes);
    all.add(std::span<const std::byte>(bytes).subspan(at, kHashBytes));
}

/// Corrects magic, version, sizes and checksums, so that what lies behind them is reached.
inline void repair(const BlockFileKind& kind, Bytes& bytes) {
    const std::size_t least = kBeforeJson + 2 * kHashBytes;
    if (bytes.size() < least) bytes.resize(least);
    std::memcpy(bytes.data(), kind.magic.data(), kind.magic.size());
    put(kind.version, 8, bytes);
    const auto json = static_cast<uint32_t>(std::min<std::size_t>(value_at<uint32_t>(bytes, 12), bytes.size() - least));
    put(json, 12, bytes);
    Hasher all;
    std::size_t at = kBeforeJson + json;
    put_hash(0, at, all, bytes);
    at += kHashBytes;
    const std::size_t end = bytes.size() - kHashBytes, around = sizeof(uint32_t) + kHashBytes;
    while (end - at >= around) {
        const auto size =
            static_cast<uint32_t>(std::min<std::size_t>(value_at<uint32_t>(bytes, at), end - at - around));
        put(size, at, bytes);
        put_hash(at, at + sizeof(uint32_t) + size, all, bytes);
        at += around + size;
    }
    bytes.resize(at + kHashBytes);
    const Hash128 hash = all.result();
    put(hash.low, at, bytes), put(hash.high, at + 8, bytes);
}

/// A file in memory, by its name.
class FileInMemory {
public:
    explicit FileInMemory(const Bytes& bytes) : file_(::memfd_create("fuzz", 0)) {
        if (file_ < 0 || ::write(file_, bytes.data(), bytes.size()) != static_cast<ssize_t>(bytes.size())) std::abort();
    }
    ~FileInMemory() { ::close(file_); }
    FileInMemory(const FileInMemory&) = delete;
    FileInMemory& operator=(const FileInMemory&) = delete;
    std::string name() const { return fmt::format("/proc/self/fd/{}", file_); }

private:
    int file_;
};

inline Queue& cpu() {
    static Queue queue = Queue::make_cpu(Threads(1));
    return queue;
}

inline void require(bool is_so) {
    if (!is_so) std::abort();
}

} // namespace pertev
