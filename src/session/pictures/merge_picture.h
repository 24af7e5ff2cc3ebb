#pragma once

// Merges film files into one picture for its files or arrays.

#include <span>
#include <string>
#include <vector>

#include "session/film_file/merge_films.h"
#include "session/pictures/show_merged.h"

namespace pertev {

struct MergedPicture {
    RenderResult result;
    PictureFacts facts;             // for the outputs
    std::vector<WrittenFile> films; // the film files among the outputs, which have been written
};

/// The caller's choices of a merge.
struct MergeOptions {
    bool is_partial = false; // samples may be missing
    std::string denoise;     // the denoiser of the picture, for which the films must have been rendered; empty: theirs
    MergedDisplay display = {};
};

/// Checks the names of the outputs, merges `files`, and writes the film files among the outputs; write_picture() writes
/// the others. Throws as check_outputs and FilmMerge, and Error(BadInput) for a film file of samples with gaps, and
/// for films that lack what the denoiser needs.
MergedPicture merge_picture(std::span<const std::string> files, const MergeOptions& options,
                            std::span<const std::string> outputs, Sink& sink);

} // namespace pertev
