#include "integrators/path/host_shading_body.h"

namespace pertev {

template <>
ShadeOnHost<LayerListeners> shading_for<LayerListeners>(const PictureView& picture) {
    return choose_shading_on_host<LayerListeners, LayerFeatures>(picture);
}

} // namespace pertev
