#pragma once

// Parameters of a statement: `"TYPE NAME" VALUE` or `"TYPE NAME" [ VALUES ]`.

#include "base/sink.h"
#include "formats/described/parameters.h"
#include "formats/pbrt/context.h"
#include "formats/pbrt/tokens.h"

namespace pertev::pbrt {

/// Adds the parameters at the front of `tokens`. An unreadable one is left out with a warning.
void read_parameters(Tokens& tokens, Parameters& parameters, Sink& sink);

} // namespace pertev::pbrt
