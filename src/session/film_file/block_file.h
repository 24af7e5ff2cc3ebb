#pragma once

// The frame of film files (docs/film_file.md) and of histories: magic and version, a header in JSON, packed blocks,
// each with a hash, and in the end a hash of all hashes. A file that is cut off, or in which a byte has changed, is
// always found.

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/error.h"
#include "base/hash.h"
#include "base/read_file.h"

namespace pertev {

inline constexpr uint32_t kMaxFilmHeaderBytes = 1u << 28;

/// Number of elements of `stride` bytes in a block, except for an array's last.
constexpr std::size_t film_block_elements(std::size_t stride) {
    return std::clamp<std::size_t>((std::size_t(1) << 22) / stride, 1, std::size_t(1) << 15);
}

/// A kind of file, by what it begins with.
struct BlockFileKind {
    std::string_view magic;
    uint32_t version;
    std::string_view name;             // for people: "film"
    uint32_t oldest_version = version; // the oldest one that is read
};

/// The bytes of a file, in the order of x86, which is the file's.
class BlockFileBytes {
public:
    BlockFileBytes(const BlockFileKind& kind, std::string_view json);
    /// Adds a block whose elements have `stride` bytes.
    void add_block(std::span<const std::byte> elements, std::size_t stride) { add_packed(packed(elements, stride)); }
    /// Adds all blocks of an array, which are packed in parallel.
    void add_array(std::span<const std::byte> elements, std::size_t stride);
    /// Ends the file and returns it.
    std::vector<std::byte> take();

private:
    static std::vector<std::byte> packed(std::span<const std::byte> elements, std::size_t stride);
    void add_packed(std::span<const std::byte> packed);
    void add(std::span<const std::byte> bytes) { bytes_.insert(bytes_.end(), bytes.begin(), bytes.end()); }
    template <class T>
    void add_value(const T& value) {
        add(std::as_bytes(std::span(&value, 1)));
    }
    void add_hash(std::size_t first);
    void add_result(const Hasher& hasher);

    std::vector<std::byte> bytes_;
    Hasher hashes_;
};

/// Reads a block file, block by block. All functions throw Error(BadInput) with the file and the reason.
class BlockFileReader {
public:
    /// Opens the file and reads its header.
    BlockFileReader(const std::filesystem::path& path, const BlockFileKind& kind);

    const std::string& name() const { return name_; }
    const std::string& json() const { return json_; }
    /// Hash of everything before the blocks.
    Hash128 header_hash() const { return header_hash_; }
    /// Throws if the rest of the file is too short for blocks of `fewest_bytes` bytes and the file's hash.
    void check_size(uint64_t fewest_bytes) const;
    /// The fewest bytes that the blocks of an array take.
    static uint64_t fewest_bytes(uint64_t bytes, std::size_t stride);
    /// Reads the next block into `elements`.
    void read_block(std::span<std::byte> elements, std::size_t stride);
    /// Reads all blocks of an array.
    void read_array(std::span<std::byte> elements, std::size_t stride);
    /// Checks the hash of the whole file, after which the file must end.
    void finish();
    Error error(const std::string& why) const { return {ErrorCode::BadInput, FileLocation{name_}, why}; }

private:
    void read(std::span<std::byte> to);
    template <class T>
    T read_value();
    Hash128 check_hash(const Hasher& hasher, const std::string& what);

    std::string name_;
    std::string_view kind_;
    InputFile file_;
    uint64_t size_, at_ = 0; // bytes of the file, and how many were read
    Hasher hashes_;          // takes the hashes of the header and of the blocks
    std::string json_;
    Hash128 header_hash_;
    std::vector<std::byte> packed_;
};

} // namespace pertev
