#include "device/launch_body.h"
#include "render/count_hidden_backs.h"

namespace pertev {
template void launch(Queue&, const char*, uint32_t, const CountHiddenBacks&);
} // namespace pertev
