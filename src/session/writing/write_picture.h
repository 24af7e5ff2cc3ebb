#pragma once

// Writes the files of a finished picture, with as many of its layers, display and metadata as each format can hold.

#include <span>
#include <string>
#include <vector>

#include "image/image_format.h"
#include "session/writing/picture_metadata.h"

namespace pertev {

struct WrittenFile {
    std::string path;
    std::string failure; // why it could not be written; empty on success
};

struct WrittenPicture {
    std::string hash;          // hash of the film's picture (image/picture_hash.h)
    std::string layers_hash;   // hash of everything else in an EXR (hash_of_layers); empty if there is nothing
    std::string denoised_hash; // hash of the picture that files show in its place; empty if they show the film's
    std::vector<WrittenFile> files;
};

/// Returns why files could not be written, in one text; empty if all were.
std::string failures_of(const WrittenPicture& written);
/// Throws Error(FileWrite), with the file's place if it is one, if a file could not be written, and, if `strict`, as
/// refuse_invalid_samples().
void refuse_faults(const WrittenPicture& written, uint64_t invalid_samples, bool strict);

/// Returns all metadata of an EXR of a result, whose picture has this hash.
ExrMetadata file_metadata(const PictureFacts& facts, const RenderResult& result, const std::string& hash);

/// If a result has been denoised, files show that; EXR keeps the film's picture as the layer `noisy`.

/// Encodes a PNG or EXR file. Takes the layers out of `result`.
std::vector<std::byte> encode_picture(ImageFormat format, const PictureRecord& record, RenderResult& result);

/// Writes `result` to each of `paths`, whose extensions select the format (image/write_image.h), each atomically. A
/// failure does not prevent the others from being written. Takes the layers out of `result`. Film files are left to
/// write_film_files().
WrittenPicture write_picture(std::span<const std::string> paths, const PictureFacts& facts, RenderResult& result);
WrittenPicture write_picture(std::span<const std::string> paths, const PictureRecord& record, RenderResult& result);

} // namespace pertev
