#include "formats/json/json_file.h"
#include "session/film_file/film_file.h"

namespace pertev {
namespace {

/// Returns the fewest bytes that the blocks of a film with this header take in a file.
uint64_t fewest_bytes(const FilmHeader& header) {
    Queue queue = Queue::make_dry_run(false);
    const Film film = header.make_film(queue);
    uint64_t bytes = 0;
    for (const auto& target : film.targets())
        bytes += BlockFileReader::fewest_bytes(target->byte_count(), target->stride());
    return bytes;
}

} // namespace

FilmFileReader::FilmFileReader(const std::filesystem::path& path) : file_(path, kFilmFile) {
    const JsonFile parsed(file_.name(), file_.json());
    header_ = read_film_header(parsed.root());
    file_.check_size(fewest_bytes(header_));
}

void FilmFileReader::add_to(Film& film) {
    std::vector<std::byte> block;
    for (const auto& target : film.targets()) {
        const std::size_t stride = target->stride(), most = film_block_elements(stride) * stride;
        for (std::size_t first = 0; first < target->byte_count(); first += most) {
            block.resize(std::min(most, target->byte_count() - first));
            file_.read_block(block, stride);
            target->add_bytes(first, block);
        }
    }
    file_.finish();
}

} // namespace pertev
