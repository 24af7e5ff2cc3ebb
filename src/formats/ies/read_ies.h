#pragma once

// Reader of IES photometric files: the candelas of a luminaire by direction.
//
// Source: ANSI/IES LM-63-2019 and its editions of 1986 to 2002. In photometry of type C the vertical angle 0 is the
// table's +z (nadir), the horizontal angle 0 its +x, and horizontal angles run towards +y, counter-clockwise seen from
// above. A file with horizontal angles from 0 to 0, 90 or 180 (or from 90 to 270) is symmetric. In types A and B both
// angles are 0 at +z and grow to +x and +y; the poles are at +y and -y in type A, at +x and -x in type B, and
// horizontal angles from 0 are symmetric. Candelas are multiplied by the file's multiplier and ballast factor, before
// 1995 also by the `ballast-lamp factor`. Lumens, sizes, watts and keywords do not matter; neither does TILT,
// which is about a luminaire that hangs otherwise.

#include <filesystem>
#include <string>
#include <string_view>

#include "base/sink.h"
#include "scene/intensity_table.h"

namespace pertev {

/// Returns the table of a file's `text`, whose values are candelas. `name` is that of the file, for messages. Between
/// the file's angles intensity is bilinear. It is exact if the vertical angles are multiples of a 1440th of their
/// range, and the horizontal ones of a quarter of a degree; a table of such steps comes near others, and one of half
/// degrees around the light, with 720 rows, near those of types A and B. Throws Error(BadInput), with the line, if it
/// is no such file.
IntensityTable parse_ies(std::string_view text, const std::string& name, Sink& sink);

/// Reads the file at `path`. Throws Error(BadInput).
IntensityTable read_ies(const std::filesystem::path& path, Sink& sink);

} // namespace pertev
