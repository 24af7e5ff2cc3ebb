#pragma once

// Checks the names of a picture's files before it is rendered.

#include <span>
#include <string>

#include "base/sink.h"
#include "settings/picture_options.h"

namespace pertev {

/// Returns whether the name is that of a film file (session/film_file/): .pvf, in either case.
bool is_film_name(const std::string& output);
/// Returns whether one of outputs is a film file.
bool writes_films(std::span<const std::string> outputs);
/// Returns whether one of the files is tone-mapped: PNG or JPEG.
bool writes_tone_mapped(std::span<const std::string> outputs);

/// Notes that # in the name of a single output stands for a number where there are several.
void note_number_signs(const std::string& output, Sink& sink);

/// Throws Error for a name that cannot be written, for two names of one file, for a name that frames would share, and
/// for a setting of the caller that no file shows (Setting::formats). Warns of alpha that a file cannot have.
void check_outputs(const PictureOptions& options, std::span<const std::string> outputs, Sink& sink);

} // namespace pertev
