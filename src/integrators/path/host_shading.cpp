#include "integrators/path/host_shading.h"

namespace pertev {
namespace {

/// All that it calls is in line: g++ by itself would leave a dozen calls, for a third more time of Bitterli's box.
template <MaterialsKnown kKnown, bool kIsFrame, MotionKnown kMotion>
[[gnu::flatten]] bool shade(const PictureView& picture, const PathSettings& settings, const FilmView& film,
                            PathState& path, const Hit& hit, const DrawnNumbers& numbers, ShadowRay& shadow,
                            bool& wants_shadow) {
    return shade_hit<kKnown, kIsFrame, kIsFrame, kMotion>(picture, settings, film, path, hit, numbers, shadow,
                                                          wants_shadow);
}

template <MaterialsKnown kKnown>
ShadeOnHost shading_of(bool is_frame, bool moves) {
    if (is_frame || moves) return shade<kKnown, true, MotionKnown::Perhaps>;
    return shade<kKnown, false, MotionKnown::None>;
}

} // namespace

ShadeOnHost shading_for(const PictureView& picture, const FilmView& film) {
    const bool is_frame = film.frame.is_there(), moves = picture.scene.motions.is_there();
    switch (picture.scene.known) {
    case MaterialsKnown::Nothing:
        break;
    case MaterialsKnown::Diffuse:
        return shading_of<MaterialsKnown::Diffuse>(is_frame, moves);
    case MaterialsKnown::PlainDiffuse:
        return shading_of<MaterialsKnown::PlainDiffuse>(is_frame, moves);
    }
    return shading_of<MaterialsKnown::Nothing>(is_frame, moves);
}

} // namespace pertev
