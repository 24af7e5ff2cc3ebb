#include "integrators/raster/raster_integrator.h"

#include <algorithm>

#include <fmt/format.h>

#include "base/error.h"
#include "device/launch.h"
#include "integrators/raster/shade_pixels.h"
#include "shading/with_stacks.h"

namespace pertev {
namespace {

/// Returns the maximum number of rows deferred to the second pass; triangles beyond it are scanned in the first one.
uint64_t rows_for(uint64_t pixels) { return std::clamp<uint64_t>(pixels, 1u << 12, 1u << 22); }

} // namespace

void RasterIntegrator::reserve(const WorkSize& size) {
    row_count_.grow(queue_, 1, "rows of triangles");
    depths_.grow(queue_, size.pixels(), "depth buffer");
    rows_.grow(queue_, rows_for(size.pixels()), "rows of triangles");
}

void RasterIntegrator::begin(const PictureView& picture, SceneTracer& tracer, uint32_t samples) {
    if (picture.scene.triangle_count >= kNoHit) {
        throw Error(ErrorCode::OverLimit, "integrator", "raster",
                    fmt::format("{} triangles in all instances of the scene; the limit is {}",
                                picture.scene.triangle_count, kNoHit - 1));
    }
    IntegratorBase::begin(picture, tracer, samples);
    camera_ = make_pinhole(picture.camera);
    const LightSetView& lights = picture.scene.lights;
    if (!settings_.has_ambient && lights.has_environment()) picture_settings_.ambient = lights.environment.mean;
}

void RasterIntegrator::render(uint32_t first, uint32_t count, const FilmView& film) {
    check_sums(film);
    const auto triangles = static_cast<uint32_t>(picture_.scene.triangle_count);
    for (uint32_t sample = first; sample < first + count; ++sample) {
        if (is_abandoned()) return;
        const RasterPass pass = {camera_,      picture_,          picture_settings_, depths_.data(),
                                 rows_.data(), row_count_.data(), rows_.size(),      sample};
        depths_.fill(0xff); // kNoDepth
        if (picture_settings_.display.is_wireframe) {
            launch(queue_, "draw_edges", triangles, DrawEdges{pass});
        } else {
            row_count_.zero();
            launch(queue_, "scan_triangles", triangles, ScanTriangles{pass});
            launch(queue_, "scan_rows", static_cast<uint32_t>(rows_.size()), ScanRows{pass});
        }
        with_stacks(picture_.scene.variant, [&]<ShadingVariant kVariant>() {
            launch_for_pixels("shade_pixels", ShadePixels<kVariant>{pass, film});
        });
    }
    queue_.wait();
}

} // namespace pertev
