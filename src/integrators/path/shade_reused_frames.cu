#include "device/launch_body.h"
#include "integrators/path/path_stages.h"

// Instantiations for frames that leave light to ReSTIR.
namespace pertev {
template void launch(Queue&, const char*, WorkCount, const Shade<kPlainDiffuse, PlainReuseListeners>&);
template void launch(Queue&, const char*, WorkCount, const Shade<kDiffuse, PlainReuseListeners>&);
template void launch(Queue&, const char*, WorkCount, const Shade<kAllMaterials, ReuseListeners>&);
} // namespace pertev
