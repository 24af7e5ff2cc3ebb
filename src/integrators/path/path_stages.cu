#include "device/launch_body.h"
#include "integrators/path/path_stages.h"

// Those that compile soon: shading has files of its own.
namespace pertev {
template void launch(Queue&, const char*, WorkCount, const PlanRound&);
template void launch(Queue&, const char*, WorkCount, const GeneratePaths&);
template void launch(Queue&, const char*, WorkCount, const AddLight&);
template void launch(Queue&, const char*, WorkCount, const AddToFilm&);
} // namespace pertev
