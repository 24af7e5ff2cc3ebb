#include "session/film_file/block_file.h"

#include <cstdio>

#include <fmt/format.h>

#include "base/parallel_for.h"
#include "session/film_file/packed_block.h"

namespace pertev {
namespace {

constexpr std::size_t kHashBytes = 16;

} // namespace

BlockFileBytes::BlockFileBytes(const BlockFileKind& kind, std::string_view json) {
    if (json.size() > kMaxFilmHeaderBytes) { // by names of many things
        throw Error(ErrorCode::OverLimit,
                    fmt::format("the header of the {} file takes {} bytes, more than {}; fewer layers of ids take less",
                                kind.name, json.size(), kMaxFilmHeaderBytes));
    }
    add(std::as_bytes(std::span(kind.magic)));
    add_value(kind.version);
    add_value(static_cast<uint32_t>(json.size()));
    add(std::as_bytes(std::span(json)));
    add_hash(0);
}

std::vector<std::byte> BlockFileBytes::packed(std::span<const std::byte> elements, std::size_t stride) {
    return pack_block(elements, stride);
}

void BlockFileBytes::add_packed(std::span<const std::byte> packed) {
    const std::size_t begin = bytes_.size();
    add_value(static_cast<uint32_t>(packed.size()));
    add(packed);
    add_hash(begin);
}

void BlockFileBytes::add_array(std::span<const std::byte> elements, std::size_t stride) {
    const std::size_t most = film_block_elements(stride) * stride;
    std::vector<std::vector<std::byte>> blocks((elements.size() + most - 1) / most);
    parallel_for(blocks.size(), 1, [&](uint64_t i) {
        blocks[i] = packed(elements.subspan(i * most, std::min(most, elements.size() - i * most)), stride);
    });
    for (const std::vector<std::byte>& block : blocks) add_packed(block);
}

std::vector<std::byte> BlockFileBytes::take() {
    add_result(hashes_);
    return std::move(bytes_);
}

/// Adds the hash of all bytes from `first` on.
void BlockFileBytes::add_hash(std::size_t first) {
    Hasher hasher;
    hasher.add(std::span<const std::byte>(bytes_).subspan(first));
    const std::size_t at = bytes_.size();
    add_result(hasher);
    hashes_.add(std::span<const std::byte>(bytes_).subspan(at));
}

void BlockFileBytes::add_result(const Hasher& hasher) {
    const Hash128 hash = hasher.result();
    add_value(hash.low), add_value(hash.high);
}

BlockFileReader::BlockFileReader(const std::filesystem::path& path, const BlockFileKind& kind)
    : name_(path.string()), kind_(kind.name), file_(open_file(path)), size_(std::filesystem::file_size(path)) {
    std::string magic(kind.magic.size(), '\0');
    const auto refuse_other = [&] { return error(fmt::format("this is not a {} file", kind_)); };
    if (size_ < magic.size()) throw refuse_other();
    read(std::as_writable_bytes(std::span(magic)));
    if (magic != kind.magic) throw refuse_other();
    const auto version = read_value<uint32_t>();
    if (version < kind.oldest_version || version > kind.version) {
        throw error(fmt::format("the file has version {} of the format; this program reads versions {} to {}", version,
                                kind.oldest_version, kind.version));
    }
    const auto size = read_value<uint32_t>();
    if (size > kMaxFilmHeaderBytes || size > size_) throw error("the header is damaged");
    json_.resize(size);
    read(std::as_writable_bytes(std::span(json_)));
    Hasher hasher;
    hasher.add(std::as_bytes(std::span(magic)));
    hasher.add_value(version);
    hasher.add_value(size);
    hasher.add(std::as_bytes(std::span(json_)));
    header_hash_ = check_hash(hasher, "header");
}

uint64_t BlockFileReader::fewest_bytes(uint64_t bytes, std::size_t stride) {
    const uint64_t block = film_block_elements(stride) * stride;
    return (bytes + block - 1) / block * (sizeof(uint32_t) + least_packed_bytes(stride) + kHashBytes);
}

void BlockFileReader::check_size(uint64_t fewest) const {
    if (const uint64_t bytes = at_ + fewest + kHashBytes; bytes > size_)
        throw error(
            fmt::format("the file is truncated: it has {} bytes, and its {} takes at least {}", size_, kind_, bytes));
}

void BlockFileReader::read_block(std::span<std::byte> elements, std::size_t stride) {
    const uint64_t begin = at_;
    const auto size = read_value<uint32_t>();
    if (size > size_ - at_) throw error(fmt::format("the block at byte {} is truncated or damaged", begin));
    packed_.resize(size);
    read(packed_);
    Hasher hasher;
    hasher.add_value(size);
    hasher.add(packed_);
    check_hash(hasher, fmt::format("block at byte {}", begin));
    if (!unpack_block(packed_, stride, elements))
        throw error(fmt::format("the block at byte {} has invalid contents", begin));
}

void BlockFileReader::read_array(std::span<std::byte> elements, std::size_t stride) {
    const std::size_t most = film_block_elements(stride) * stride;
    for (std::size_t first = 0; first < elements.size(); first += most)
        read_block(elements.subspan(first, std::min(most, elements.size() - first)), stride);
}

void BlockFileReader::finish() {
    check_hash(hashes_, "whole file");
    if (at_ != size_) throw error(fmt::format("{} bytes follow the end of the {}", size_ - at_, kind_));
}

void BlockFileReader::read(std::span<std::byte> to) {
    if (to.size() > size_ - at_) throw error(fmt::format("the file is truncated after {} bytes", size_));
    if (std::fread(to.data(), 1, to.size(), file_.get()) != to.size())
        throw error("cannot read: the file ended early or the disk failed");
    at_ += to.size();
}

template <class T>
T BlockFileReader::read_value() {
    T value;
    read(std::as_writable_bytes(std::span(&value, 1)));
    return value;
}

/// Reads the hash that follows what `hasher` was given.
Hash128 BlockFileReader::check_hash(const Hasher& hasher, const std::string& what) {
    const Hash128 hash = hasher.result();
    const auto low = read_value<uint64_t>(), high = read_value<uint64_t>();
    if (hash != Hash128{high, low})
        throw error(fmt::format("the file is damaged: the checksum of the {} is wrong", what));
    hashes_.add_value(low), hashes_.add_value(high);
    return hash;
}

} // namespace pertev
