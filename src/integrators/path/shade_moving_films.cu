#include "device/launch_body.h"
#include "integrators/path/path_stages.h"

// Of what moves while the shutter is open, or of a camera alone that does.
namespace pertev {
template void launch(Queue&, const char*, WorkCount, const Shade<kPlainDiffuse | kMoving, FilmListeners>&);
template void launch(Queue&, const char*, WorkCount, const Shade<kDiffuse | kMoving, FilmListeners>&);
template void launch(Queue&, const char*, WorkCount, const Shade<kAllMaterials | kMoving, FilmListeners>&);
} // namespace pertev
