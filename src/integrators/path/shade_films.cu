#include "device/launch_body.h"
#include "integrators/path/path_stages.h"

namespace pertev {
template void launch(Queue&, const char*, WorkCount, const Shade<kPlainDiffuse, FilmListeners>&);
template void launch(Queue&, const char*, WorkCount, const Shade<kDiffuse, FilmListeners>&);
template void launch(Queue&, const char*, WorkCount, const Shade<kAllMaterials, FilmListeners>&);
} // namespace pertev
