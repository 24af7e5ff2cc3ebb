#pragma once

// Checks the options of a picture before anything is read, whoever set them.

#include <cstdint>

#include "settings/picture_options.h"

namespace pertev {

/// Throws Error, with the setting and its value, for the first option that cannot be: by the rules of the table
/// (settings/check_settings.h), by its text, or because the integrator cannot do it.
void check_options(const PictureOptions& options, uint32_t verbs);

/// Checks the options with their number of samples, which it sets: a frame in real time has one by default, and a
/// picture of `samples` all before their end.
void complete_options(PictureOptions& options, uint32_t verbs);

} // namespace pertev
