#pragma once

// The files of a finished picture: what each format can hold of its layers, its display and how it was made.

#include <span>
#include <string>
#include <vector>

#include "image/image_format.h"
#include "session/writing/picture_metadata.h"

namespace pertev {

struct WrittenFile {
    std::string path;
    std::string failure; // why it could not be written; empty where it was
};

struct WrittenPicture {
    std::string hash;          // of the film's picture (image/picture_hash.h)
    std::string layers_hash;   // of all else that an EXR holds of it (hash_of_layers); empty: nothing
    std::string denoised_hash; // of what files show in its place, as of the film's picture; empty: they show that
    std::vector<WrittenFile> files;
};

/// Where a result has been denoised, files show that; EXR keeps the film's picture beside it, as the layer `noisy`.

/// The bytes of such a file, PNG or EXR. Takes the layers out of `result`.
std::vector<std::byte> encode_picture(ImageFormat format, const PictureRecord& record, RenderResult& result);

/// Writes `result` to each of `paths`, whose extensions say the format (image/write_image.h), each all or nothing; one
/// that fails does not keep the others from being written. Takes the layers out of `result`.
WrittenPicture write_picture(std::span<const std::string> paths, const PictureRecord& record, RenderResult& result);

} // namespace pertev
