#include "device/launch_body.h"
#include "integrators/path/path_stages.h"

// Instantiations for motion while the shutter is open, of the camera or of anything else.
namespace pertev {
template void launch(Queue&, const char*, WorkCount, const Shade<kPlainDiffuse | kMoving, FilmListeners>&);
template void launch(Queue&, const char*, WorkCount, const Shade<kDiffuse | kMoving, FilmListeners>&);
template void launch(Queue&, const char*, WorkCount, const Shade<kAllMaterials | kMoving, FilmListeners>&);
} // namespace pertev
