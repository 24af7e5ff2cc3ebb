#include "device/launch_body.h"
#include "integrators/path/path_stages.h"

// Instantiations for batches of pictures.
namespace pertev {
template void launch(Queue&, const char*, WorkCount, const Shade<kPlainDiffuse | kBatched, FilmListeners>&);
template void launch(Queue&, const char*, WorkCount, const Shade<kDiffuse | kBatched, FilmListeners>&);
template void launch(Queue&, const char*, WorkCount, const Shade<kAllMaterials | kBatched, FilmListeners>&);
template void launch(Queue&, const char*, WorkCount, const Shade<kAllMaterials | kMoving | kBatched, FilmListeners>&);
} // namespace pertev
