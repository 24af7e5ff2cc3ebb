#pragma once

// Formats remarks of the libraries (base/remark.h) for the viewer: a setting becomes the label of its row in the
// panel.

#include <string>

#include "base/remark.h"

namespace pertev {

/// All parts as one text: "with \"Light\" cast at most 12" for "with `integrator=cast` at most 12". A setting without
/// a row keeps its own name, with spaces.
std::string panel_phrase(const Remark& remark);

} // namespace pertev
