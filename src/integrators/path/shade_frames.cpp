#include "integrators/path/host_shading_body.h"

namespace pertev {

template <>
ShadeOnHost<ReuseListeners> shading_for<ReuseListeners>(const PathJob& job) {
    return choose_shading_on_host<ReuseListeners, FrameFeatures>(job);
}

} // namespace pertev
