#pragma once

// Primary visibility by rasterization: begin() sorts the scene's triangles into lists per tile of the picture
// (render/raster/tile_lists.h), and the ray of every sample tests only its tile's list. The ray-triangle test
// decides, so hits equal those of any tracer to the bit.
//
// Memory is known in advance: if the lists of 8 x 8 pixel tiles do not fit, tiles are larger.

#include <cstdint>

#include "device/buffer.h"
#include "device/work_count.h"
#include "render/picture_view.h"
#include "render/raster/find_in_tile.h"

namespace pertev {

class CameraRaster {
public:
    /// Makes a rasterizer; `queue` outlives it.
    explicit CameraRaster(Queue& queue) : queue_(queue) {}

    /// Allocates memory for a picture of this size if needed; begin() calls it. Throws Error(OutOfMemory).
    void reserve(uint64_t triangles, uint32_t width, uint32_t height);
    /// Makes the lists for this picture, whose camera has no lens (why_no_raster). Throws Error(OutOfMemory,
    /// DeviceFault), and Error(OverLimit) for a scene with too many triangles, or too many in view.
    void begin(const PictureView& picture);
    const TileRasterView& view() const { return view_; }
    /// Finds the hits of rays [0, count) of its picture, in the form of FindInTiles. The work is queued.
    void find_hits(const RayQueueView& rays, WorkCount count, const HitQueueView& hits);

private:
    bool make_lists(const Pinhole& camera, uint32_t shift);

    Queue& queue_;
    SceneView scene_{};
    TileRasterView view_{};
    Buffer<TileCounts> counts_;
    Buffer<BvhTriangle> triangles_;
    Buffer<uint64_t> codes_, sorted_codes_;
    Buffer<uint32_t> order_, sorted_order_, entry_triangles_;
    Buffer<Uint2> rows_, tiles_;
    Buffer<std::byte> scratch_;
};

} // namespace pertev
