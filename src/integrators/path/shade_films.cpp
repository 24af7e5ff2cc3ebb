#include "integrators/path/host_shading_body.h"

namespace pertev {

template <>
ShadeOnHost<FilmListeners> shading_for<FilmListeners>(const PictureView& picture) {
    return choose_shading_on_host<FilmListeners, FilmFeatures>(picture);
}

} // namespace pertev
