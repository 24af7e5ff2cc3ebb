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
    uint32_t least_samples = 0;     // samples of the rows with the fewest; result.samples is that of the most
    PictureFacts facts;             // for the outputs
    std::vector<WrittenFile> films; // the film files among the outputs, which have been written
};

/// Checks the names of the outputs, merges `files`, and writes the film files among the outputs; write_picture() writes
/// the others. Samples may be missing if it `is_partial`: then each pixel is the mean of its row's samples, and if rows
/// have unequal numbers of samples, a warning and the facts name these rows. `options` has the caller's display
/// settings and `denoise`, which must be the films'; the other settings are the films'. Throws as check_outputs,
/// FilmMerge and show_merged, and Error(BadInput) for films that lack what the denoiser needs.
MergedPicture merge_picture(std::span<const std::string> files, bool is_partial, const PictureOptions& options,
                            std::span<const std::string> outputs, Sink& sink);

} // namespace pertev
