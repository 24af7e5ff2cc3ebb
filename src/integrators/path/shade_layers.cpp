#include "integrators/path/host_shading_body.h"

namespace pertev {

template <>
ShadeOnHost<LayerListeners> shading_for<LayerListeners>(const PathJob& job) {
    return choose_shading_on_host<LayerListeners, LayerFeatures>(job);
}

} // namespace pertev
