#include "radiosity/row_maker.h"

namespace pertev {

RowMakers::RowMakers(const SolvedScene& scene, const PatchTree& sources, const RadiositySettings& settings,
                     WorkWatch* watch)
    : scene_{scene, sources, watch}, settings_(settings) {
    if (settings.form_factors == FormFactors::Hemicube) hemicube_.emplace(scene.view(), settings.hemicube);
}

std::unique_ptr<RowMaker> RowMakers::for_thread() const {
    return hemicube_ ? make_hemicube_rows(scene_, settings_, *hemicube_) : make_ray_rows(scene_, settings_);
}

} // namespace pertev
