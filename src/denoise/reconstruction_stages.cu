#include "denoise/accumulate_signals.h"
#include "denoise/anti_alias.h"
#include "denoise/clamp_history.h"
#include "denoise/compose_picture.h"
#include "denoise/split_signals.h"
#include "denoise/wavelet_pass.h"
#include "device/launch_body.h"

namespace pertev {
template void launch(Queue&, const char*, WorkCount, const SplitSignals&);
template void launch(Queue&, const char*, WorkCount, const AccumulateSignals<false>&);
template void launch(Queue&, const char*, WorkCount, const AccumulateSignals<true>&);
template void launch(Queue&, const char*, WorkCount, const ClampHistory&);
template void launch(Queue&, const char*, WorkCount, const WaveletPass&);
template void launch(Queue&, const char*, WorkCount, const ComposePicture&);
template void launch(Queue&, const char*, WorkCount, const AntiAlias&);
template void launch(Queue&, const char*, WorkCount, const ShowPicture&);
} // namespace pertev
