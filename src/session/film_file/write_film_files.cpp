#include <algorithm>
#include <utility>

#include "base/write_file_atomically.h"
#include "session/film_file/film_file.h"
#include "session/film_file/packed_block.h"
#include "session/film_file/packed_plane.h"
#include "session/writing/check_outputs.h"

namespace pertev {
namespace {

/// The bytes of a file, in the order of x86, which is the file's.
class FilmBytes {
public:
    void add(std::span<const std::byte> bytes) { append(bytes, bytes_); }
    template <class T>
    void add_value(const T& value) {
        add(std::as_bytes(std::span(&value, 1)));
    }
    /// Adds the hash of all bytes from `first` on.
    void add_hash(std::size_t first) {
        Hasher hasher;
        hasher.add(std::span<const std::byte>(bytes_).subspan(first));
        const std::size_t at = bytes_.size();
        add_result(hasher);
        hashes_.add(std::span<const std::byte>(bytes_).subspan(at));
    }
    /// Adds the hash of all these hashes.
    void add_hash_of_hashes() { add_result(hashes_); }
    void add_target(const FilmTarget& target) {
        const std::size_t stride = target.stride(), most = film_block_elements(stride) * stride;
        std::vector<std::byte> block;
        for (std::size_t first = 0; first < target.byte_count(); first += most) {
            block.resize(std::min(most, target.byte_count() - first));
            target.read(first, block);
            const std::vector<std::byte> packed = pack_block(block, stride);
            const std::size_t begin = bytes_.size();
            add_value(static_cast<uint32_t>(packed.size()));
            add(packed);
            add_hash(begin);
        }
    }
    std::vector<std::byte> take() { return std::move(bytes_); }

private:
    void add_result(const Hasher& hasher) {
        const Hash128 hash = hasher.result();
        add_value(hash.low), add_value(hash.high);
    }

    std::vector<std::byte> bytes_;
    Hasher hashes_;
};

} // namespace

std::vector<std::byte> film_file_bytes(const FilmHeader& header, const Film& film) {
    FilmBytes file;
    const std::string json = json_of(header);
    PERTEV_CHECK(json.size() <= kMaxFilmHeaderBytes);
    file.add(std::as_bytes(std::span(kFilmFileMagic)));
    file.add_value(kFilmFileVersion);
    file.add_value(static_cast<uint32_t>(json.size()));
    file.add(std::as_bytes(std::span(json)));
    file.add_hash(0);
    for (const auto& target : film.targets()) file.add_target(*target);
    file.add_hash_of_hashes();
    return file.take();
}

std::vector<WrittenFile> write_film_files(std::span<const std::string> outputs, const FilmHeader& header,
                                          const Film& film) {
    std::vector<WrittenFile> written;
    for (const std::string& path : outputs)
        if (is_film_name(path)) written.push_back({path, ""});
    if (written.empty()) return written;
    const std::vector<std::byte> bytes = film_file_bytes(header, film);
    for (WrittenFile& to : written) {
        try {
            write_file_atomically(to.path, bytes);
        } catch (const Error& error) {
            to.failure = error.what();
        }
    }
    return written;
}

} // namespace pertev
