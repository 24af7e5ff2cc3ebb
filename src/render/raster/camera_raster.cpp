#include "render/raster/camera_raster.h"

#include <algorithm>

#include <fmt/format.h>

#include "base/error.h"
#include "base/limits.h"
#include "device/launch.h"
#include "tracer/hploc/sort_codes.h"

namespace pertev {
namespace {

constexpr uint32_t kLeastShift = 3; // tiles of 8 x 8 pixels

struct Capacity {
    uint64_t triangles, entries, rows, tiles;
};

/// One tile over the whole picture takes an entry a triangle and no row, so all that are seen always fit.
Capacity capacity_for(uint64_t triangles, uint32_t width, uint32_t height) {
    const uint64_t most = std::min<uint64_t>(triangles, kMaxRasterTriangles), pixels = uint64_t(width) * height;
    const uint64_t tiles = (((uint64_t(width) - 1) >> kLeastShift) + 1) * (((uint64_t(height) - 1) >> kLeastShift) + 1);
    return {most, 2 * most + pixels / 4, most + pixels / 16, tiles};
}

template <class T>
void fit(Queue& queue, Buffer<T>& buffer, uint64_t count, const char* name) {
    if (buffer.size() >= count) return;
    buffer = Buffer<T>(); // before the new one, so that both need not fit
    buffer = Buffer<T>(queue, count, name);
}

} // namespace

std::size_t CameraRaster::predicted_bytes(uint64_t triangles, uint32_t width, uint32_t height, bool on_cuda) {
    const Capacity c = capacity_for(triangles, width, height);
    constexpr std::size_t of_entry = 2 * sizeof(uint64_t) + 3 * sizeof(uint32_t);
    const std::size_t sorting = on_cuda ? c.entries * (sizeof(uint64_t) + sizeof(uint32_t)) : 0;
    return sizeof(TileCounts) + c.triangles * sizeof(BvhTriangle) + c.entries * of_entry +
           (c.rows + c.tiles) * sizeof(Uint2) + sorting;
}

std::size_t CameraRaster::bytes() const {
    return sizeof(TileCounts) + triangles_.size() * sizeof(BvhTriangle) +
           (codes_.size() + sorted_codes_.size()) * sizeof(uint64_t) +
           (order_.size() + sorted_order_.size() + entry_triangles_.size()) * sizeof(uint32_t) +
           (rows_.size() + tiles_.size()) * sizeof(Uint2) + scratch_.size();
}

void CameraRaster::begin(const PictureView& picture) {
    scene_ = picture.scene;
    if (scene_.triangle_count > UINT32_MAX) {
        throw Error(ErrorCode::OverLimit, "integrator", "hybrid",
                    fmt::format("{} triangles in all instances of the scene; it rasterises {} at most",
                                scene_.triangle_count, UINT32_MAX));
    }
    const uint32_t width = picture.camera.width, height = picture.camera.height;
    const Capacity c = capacity_for(scene_.triangle_count, width, height);
    fit(queue_, triangles_, c.triangles, "triangles in view");
    fit(queue_, codes_, c.entries, "tile lists");
    fit(queue_, sorted_codes_, c.entries, "tile lists");
    fit(queue_, order_, c.entries, "tile lists");
    fit(queue_, sorted_order_, c.entries, "tile lists");
    fit(queue_, entry_triangles_, c.entries, "tile lists");
    fit(queue_, rows_, c.rows, "rows of tiles");
    fit(queue_, tiles_, c.tiles, "tiles");
    const Pinhole camera = make_pinhole(picture.camera);
    for (uint32_t shift = kLeastShift; !make_lists(camera, shift); ++shift) {
    }
}

/// False where they do not fit.
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
        throw Error(
            ErrorCode::OverLimit, "integrator", "hybrid",
            fmt::format("{} triangles are in view; it rasterises {} at most (`integrator=path` has no such limit)",
                        first.triangles, triangles_.size()));
    }
    if (first.entries > codes_.size() || first.rows > rows_.size()) return false;
    launch(queue_, "bin_rows", static_cast<uint32_t>(first.rows), BinRows{camera, scene_, lists});
    const uint64_t entries = counts_.download().front().entries;
    if (entries > codes_.size()) return false;
    const auto count = static_cast<uint32_t>(entries);
    if (count > 0) {
        fit(queue_, scratch_, sort_scratch_bytes(queue_, static_cast<uint32_t>(codes_.size())),
            "sorting of tile lists");
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
