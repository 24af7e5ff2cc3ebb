#include "render/raster/camera_raster.h"

#include <algorithm>

#include <fmt/format.h>

#include "base/error.h"
#include "base/limits.h"
#include "device/launch.h"
#include "tracer/hploc/sort_codes.h"

namespace pertev {
namespace {

constexpr uint32_t kMinShift = 3; // tiles of 8 x 8 pixels

struct Capacity {
    uint64_t triangles, entries, rows, tiles;
};

/// Returns the capacity of the lists. A single tile over the whole picture needs one entry per triangle and no rows, so
/// all visible ones always fit.
Capacity capacity_for(uint64_t triangles, uint32_t width, uint32_t height) {
    const uint64_t most = std::min<uint64_t>(triangles, kMaxRasterTriangles), pixels = uint64_t(width) * height;
    const uint64_t tiles = (((uint64_t(width) - 1) >> kMinShift) + 1) * (((uint64_t(height) - 1) >> kMinShift) + 1);
    return {most, 2 * most + pixels / 4, most + pixels / 16, tiles};
}

} // namespace

void CameraRaster::reserve(uint64_t triangles, uint32_t width, uint32_t height) {
    const Capacity c = capacity_for(triangles, width, height);
    counts_.grow(queue_, 1, "tile counts");
    triangles_.grow(queue_, c.triangles, "triangles in view");
    codes_.grow(queue_, c.entries, "tile lists");
    sorted_codes_.grow(queue_, c.entries, "tile lists");
    order_.grow(queue_, c.entries, "tile lists");
    sorted_order_.grow(queue_, c.entries, "tile lists");
    entry_triangles_.grow(queue_, c.entries, "tile lists");
    rows_.grow(queue_, c.rows, "rows of tiles");
    tiles_.grow(queue_, c.tiles, "tiles");
    scratch_.grow(queue_, sort_scratch_bytes(queue_, static_cast<uint32_t>(codes_.size())), "sorting of tile lists");
}

void CameraRaster::begin(const PictureView& picture) {
    scene_ = picture.scene;
    if (scene_.triangle_count > UINT32_MAX) {
        throw Error(ErrorCode::OverLimit, "integrator", "hybrid",
                    fmt::format("{} triangles in all instances of the scene; the limit is {}", scene_.triangle_count,
                                UINT32_MAX));
    }
    reserve(scene_.triangle_count, picture.camera.width, picture.camera.height);
    const Pinhole camera = make_pinhole(picture.camera);
    for (uint32_t shift = kMinShift; !make_lists(camera, shift); ++shift) {
    }
}

/// Makes the lists of tiles with sides of 2^shift pixels. Returns false if they do not fit.
bool CameraRaster::make_lists(const Pinhole& camera, uint32_t shift) {
    const uint32_t tiles_x = ((camera.width - 1) >> shift) + 1;
    tiles_.zero();
    counts_.zero();
    const TileListsView lists = {triangles_.data(),
                                 codes_.data(),
                                 order_.data(),
                                 entry_triangles_.data(),
                                 rows_.data(),
                                 counts_.data(),
                                 triangles_.size(),
                                 codes_.size(),
                                 rows_.size(),
                                 shift,
                                 tiles_x};
    launch(queue_, "bin_triangles", static_cast<uint32_t>(scene_.triangle_count), BinTriangles{camera, scene_, lists});
    const TileCounts first = counts_.download().front();
    if (first.triangles > triangles_.size()) {
        throw Error(ErrorCode::OverLimit, "integrator", "hybrid",
                    fmt::format("{} triangles are in view; the limit is {} (`integrator=path` has no limit)",
                                first.triangles, triangles_.size()));
    }
    if (first.entries > codes_.size() || first.rows > rows_.size()) return false;
    launch(queue_, "bin_rows", static_cast<uint32_t>(first.rows), BinRows{camera, scene_, lists});
    const uint64_t entries = counts_.download().front().entries;
    if (entries > codes_.size()) return false;
    const auto count = static_cast<uint32_t>(entries);
    if (count > 0) {
        sort_codes(queue_, scratch_, codes_.data(), order_.data(), sorted_codes_.data(), sorted_order_.data(), count);
        launch(
            queue_, "finish_tile_lists", count,
            FinishTileLists{sorted_codes_.data(), entry_triangles_.data(), sorted_order_.data(), tiles_.data(), count});
    }
    view_ = {
        triangles_.data(), sorted_codes_.data(), sorted_order_.data(), tiles_.data(), camera.width, shift, tiles_x};
    return true;
}

void CameraRaster::find_hits(const RayQueueView& rays, WorkCount count, const HitQueueView& hits) {
    launch(queue_, "find_in_tiles", count, FindInTiles{view_, scene_, rays, hits});
}

} // namespace pertev
