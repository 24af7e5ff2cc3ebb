#include "denoise/compose_samples.h"
#include "denoise/estimate_variance.h"
#include "denoise/gather_samples.h"
#include "device/launch_body.h"

namespace pertev {
template void launch(Queue&, const char*, WorkCount, const BeginSums&);
template void launch(Queue&, const char*, WorkCount, const GatherFeatures&);
template void launch(Queue&, const char*, WorkCount, const GatherLight&);
template void launch(Queue&, const char*, WorkCount, const SmoothGuide&);
template void launch(Queue&, const char*, WorkCount, const EstimateVariance&);
template void launch(Queue&, const char*, WorkCount, const ComposeSamples&);
} // namespace pertev
