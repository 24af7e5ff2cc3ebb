#pragma once

// Remarks of the libraries (base/remark.h) as the viewer phrases them: a setting becomes the label of its row in the
// panel.

#include <string>

#include "base/remark.h"

namespace pertev {

/// All parts of it as one text: "with \"Light\" cast at most 12" of "with `integrator=cast` at most 12". A setting
/// without a row has its own name, with spaces.
std::string panel_phrase(const Remark& remark);

} // namespace pertev
