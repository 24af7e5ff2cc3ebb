#include "device/launch_body.h"
#include "tests/support/device_stages.h"

namespace pertev {
template void launch(Queue&, const char*, WorkCount, const test::DrawSamples&);
template void launch(Queue&, const char*, WorkCount, const test::ScatterRandomly&);
template void launch(Queue&, const char*, WorkCount, const test::DrawLights&);
template void launch(Queue&, const char*, WorkCount, const test::DeformAndFold&);
template void launch(Queue&, const char*, WorkCount, const test::EvaluateMath&);
template void launch(Queue&, const char*, WorkCount, const test::ShearRays&);
template void launch(Queue&, const char*, WorkCount, const test::CountThreads&);
} // namespace pertev
