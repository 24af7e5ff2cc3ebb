#include "device/launch_body.h"
#include "integrators/path/path_stages.h"

// Instantiations of stages that compile quickly; shading has its own files.
namespace pertev {
template void launch(Queue&, const char*, WorkCount, const PlanRound&);
template void launch(Queue&, const char*, WorkCount, const GeneratePaths<false>&);
template void launch(Queue&, const char*, WorkCount, const GeneratePaths<true>&);
template void launch(Queue&, const char*, WorkCount, const AddLight<FilmListeners>&);
template void launch(Queue&, const char*, WorkCount, const AddLight<PlainFrameListeners>&);
template void launch(Queue&, const char*, WorkCount, const AddLight<FrameListeners>&);
template void launch(Queue&, const char*, WorkCount, const AddLight<PlainReuseListeners>&);
template void launch(Queue&, const char*, WorkCount, const AddLight<ReuseListeners>&);
template void launch(Queue&, const char*, WorkCount, const AddLight<LayerListeners>&);
} // namespace pertev
