#include "integrators/path/host_shading_body.h"

namespace pertev {

template <>
ShadeOnHost<FilmListeners> shading_for<FilmListeners>(const PathJob& job) {
    return choose_shading_on_host<FilmListeners, FilmFeatures>(job);
}

} // namespace pertev
