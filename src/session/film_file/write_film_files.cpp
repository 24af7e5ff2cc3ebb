#include <algorithm>
#include <utility>

#include "base/write_file_atomically.h"
#include "session/film_file/film_file.h"
#include "session/writing/check_outputs.h"

namespace pertev {

std::vector<std::byte> film_file_bytes(const FilmHeader& header, const Film& film) {
    BlockFileKind kind = kFilmFile;
    kind.version = header.parts.size() == 1 ? kFilmFileVersion : kFilmFileOfPartsVersion;
    BlockFileBytes file(kind, json_of(header));
    std::vector<std::byte> block;
    for (const auto& target : film.targets()) {
        const std::size_t stride = target->stride(), most = film_block_elements(stride) * stride;
        for (std::size_t first = 0; first < target->byte_count(); first += most) {
            block.resize(std::min(most, target->byte_count() - first));
            target->read(first, block);
            file.add_block(block, stride);
        }
    }
    return file.take();
}

std::vector<WrittenFile> write_film_files(std::span<const std::string> outputs, const FilmHeader& header,
                                          const Film& film) {
    std::vector<WrittenFile> written;
    for (const std::string& path : outputs)
        if (is_film_name(path)) written.push_back({path, ""});
    std::vector<std::byte> bytes;
    for (WrittenFile& to : written) {
        try {
            if (bytes.empty()) bytes = film_file_bytes(header, film);
            write_file_atomically(to.path, bytes);
        } catch (const Error& error) {
            to.failure = error.what();
        }
    }
    return written;
}

} // namespace pertev
