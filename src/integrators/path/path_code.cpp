#include "integrators/path/path_code.h"

#include "base/error.h"
#include "integrators/path/compiled_features.h"

namespace pertev {
namespace {

Features features_without_tree(const PathJob& job) {
    const PictureView& picture = job.picture;
    const bool has_times = picture.scene.motions.is_there() ||
                           (picture.camera.is_open && !job.film.frame.is_there() && (job.film.aovs & kAovDepth) != 0);
    const bool filters = job.settings.mip_maps == MipMaps::On && has_textures(picture.scene.variant);
    return features_of(picture.scene.variant) | (has_times ? Features{kMoving} : 0) |
           (picture.batch.is_there() ? Features{kBatched} : 0) | (filters ? Features{kMipMapped} : 0) |
           (picture.scene.nesting.is_there() ? Features{kNested} : 0) |
           (picture.scene.has_media != 0 || job.passes_thin_walls ? Features{kMedia} : 0);
}

} // namespace

bool is_compiled(PathOutput output, Features features) {
    switch (output) {
    case PathOutput::Films:
        return FilmFeatures::has(features);
    case PathOutput::Frames:
        return FrameFeatures::has(features);
    case PathOutput::ReusedFrames:
        return ReuseFeatures::has(features);
    case PathOutput::Layers:
        return LayerFeatures::has(features);
    }
    PERTEV_CHECK(false);
    return false;
}

bool uses_light_tree(const PathJob& job) {
    const PictureView& picture = job.picture;
    if (picture.camera.is_meter() || !uses_light_tree(job.settings.light_choice, picture.scene)) return false;
    return is_compiled(output_of(job), (features_without_tree(job) & ~kBatched) | kLightTree);
}

Features features_for(const PathJob& job) {
    return features_without_tree(job) | (uses_light_tree(job) ? Features{kLightTree} : 0);
}

} // namespace pertev
