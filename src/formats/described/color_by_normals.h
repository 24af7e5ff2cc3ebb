#pragma once

// Base colours that depend on the direction of a surface (pbrt's directionmix), as colours of the vertices of a mesh's
// own copy. Each face has one colour; a quadric, which the mesh only approximates, has those of its vertex normals.

#include "base/sink.h"
#include "formats/described/parts.h"

namespace pertev::described {

/// Gives shapes whose surface has a NormalMix a mesh with its colours. Copies of meshes that turn alike are shared.
/// Beyond a limit for files of this size the even mixture is used, with a warning.
void color_by_normals(Parts& parts, uint64_t file_bytes, Sink& sink);

} // namespace pertev::described
