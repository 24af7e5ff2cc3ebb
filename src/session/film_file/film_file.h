#pragma once

// Film files (.pvf, docs/film_file.md): the exact sums of a part of a picture with all that the whole picture's files
// need. The film of all parts is the film of one run, to the bit.

#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "session/film_file/block_file.h"
#include "session/film_file/film_header.h"
#include "session/writing/write_picture.h"

namespace pertev {

/// Returns the bytes of a film file.
std::vector<std::byte> film_file_bytes(const FilmHeader& header, const Film& film);
/// Writes the film files among `outputs`, each atomically, and returns them.
std::vector<WrittenFile> write_film_files(std::span<const std::string> outputs, const FilmHeader& header,
                                          const Film& film);

/// Reads one film file, block by block. A file that is cut off, or in which a byte has changed, is always found. All
/// functions throw Error(BadInput, OverLimit) with the file and the reason.
class FilmFileReader {
public:
    /// Opens the file and reads its header.
    explicit FilmFileReader(const std::filesystem::path& path);

    const FilmHeader& header() const { return header_; }
    /// Hash of everything before the blocks.
    Hash128 header_hash() const { return file_.header_hash(); }
    /// Adds all blocks to a film that is like header().make_film(). After an error the film is of no use. Called once.
    void add_to(Film& film);

private:
    BlockFileReader file_;
    FilmHeader header_;
};

} // namespace pertev
