#include <cerrno>
#include <system_error>

#include <fmt/format.h>

#include "formats/json/json_file.h"
#include "session/film_file/film_file.h"
#include "session/film_file/packed_block.h"

namespace pertev {
namespace {

constexpr std::size_t kHashBytes = 16;

/// The fewest bytes that the blocks of such a film take in a file.
uint64_t fewest_bytes(const FilmHeader& header) {
    Queue queue = Queue::make_dry_run(false);
    const Film film = header.make_film(queue);
    uint64_t bytes = 0;
    for (const auto& target : film.targets()) {
        const uint64_t stride = target->stride(), block = film_block_elements(stride) * stride;
        bytes +=
            (target->byte_count() + block - 1) / block * (sizeof(uint32_t) + least_packed_bytes(stride) + kHashBytes);
    }
    return bytes;
}

} // namespace

FilmFileReader::FilmFileReader(const std::filesystem::path& path)
    : name_(path.string()), file_(open_file(path)), size_(std::filesystem::file_size(path)) {
    std::string magic(kFilmFileMagic.size(), '\0');
    if (size_ < magic.size()) throw error("this is not a film file");
    read(std::as_writable_bytes(std::span(magic)));
    if (magic != kFilmFileMagic) throw error("this is not a film file");
    if (const auto version = read_value<uint32_t>(); version != kFilmFileVersion)
        throw error(fmt::format("the file has version {} of the format; this program reads version {}", version,
                                kFilmFileVersion));
    const auto size = read_value<uint32_t>();
    if (size > kMaxFilmHeaderBytes || size > size_) throw error("the header is damaged");
    std::string json(size, '\0');
    read(std::as_writable_bytes(std::span(json)));
    Hasher hasher;
    hasher.add(std::as_bytes(std::span(magic)));
    hasher.add_value(kFilmFileVersion);
    hasher.add_value(size);
    hasher.add(std::as_bytes(std::span(json)));
    header_hash_ = check_hash(hasher, "header");
    const JsonFile parsed(name_, json);
    header_ = read_film_header(parsed.root());
    if (const uint64_t bytes = at_ + fewest_bytes(header_) + kHashBytes; bytes > size_)
        throw error(
            fmt::format("the file is truncated: it has {} bytes, and its film takes at least {}", size_, bytes));
}

void FilmFileReader::add_to(Film& film) {
    std::vector<std::byte> block, packed;
    for (const auto& target : film.targets()) {
        const std::size_t stride = target->stride(), most = film_block_elements(stride) * stride;
        for (std::size_t first = 0; first < target->byte_count(); first += most) {
            const uint64_t begin = at_;
            read_block(packed);
            block.resize(std::min(most, target->byte_count() - first));
            if (!unpack_block(packed, stride, block))
                throw error(fmt::format("the block at byte {} has invalid contents", begin));
            target->add_bytes(first, block);
        }
    }
    check_hash(hashes_, "whole file");
    if (at_ != size_) throw error(fmt::format("{} bytes follow the end of the film", size_ - at_));
}

void FilmFileReader::read_block(std::vector<std::byte>& packed) {
    const uint64_t begin = at_;
    const auto size = read_value<uint32_t>();
    if (size > size_ - at_) throw error(fmt::format("the block at byte {} is truncated or damaged", begin));
    packed.resize(size);
    read(packed);
    Hasher hasher;
    hasher.add_value(size);
    hasher.add(packed);
    check_hash(hasher, fmt::format("block at byte {}", begin));
}

void FilmFileReader::read(std::span<std::byte> to) {
    if (to.size() > size_ - at_) throw error(fmt::format("the file is truncated after {} bytes", size_));
    if (std::fread(to.data(), 1, to.size(), file_.get()) != to.size())
        throw error(fmt::format("cannot read: the file ended early or the disk failed"));
    at_ += to.size();
}

template <class T>
T FilmFileReader::read_value() {
    T value;
    read(std::as_writable_bytes(std::span(&value, 1)));
    return value;
}

/// Reads the hash that follows what `hasher` was given.
Hash128 FilmFileReader::check_hash(const Hasher& hasher, const std::string& what) {
    const Hash128 hash = hasher.result();
    const auto low = read_value<uint64_t>(), high = read_value<uint64_t>();
    if (hash != Hash128{high, low})
        throw error(fmt::format("the file is damaged: the checksum of the {} is wrong", what));
    hashes_.add_value(low), hashes_.add_value(high);
    return hash;
}

Error FilmFileReader::error(const std::string& why) const {
    return Error(ErrorCode::BadInput, FileLocation{name_}, why);
}

} // namespace pertev
