#pragma once

// Primary visibility by rasterisation: begin() puts the scene's triangles on lists by tiles of the picture
// (render/raster/tile_lists.h), and every sample's ray looks at its tile's list alone. The ray's own test decides, so
// hits are those of any tracer, to the bit.
//
// Memory is known before: where the lists of tiles of 8 x 8 pixels would not fit, tiles are larger.

#include <cstdint>

#include "device/buffer.h"
#include "device/work_count.h"
#include "render/picture_view.h"
#include "render/raster/find_in_tile.h"

namespace pertev {

class CameraRaster {
public:
    /// `queue` outlives it.
    explicit CameraRaster(Queue& queue) : queue_(queue) {}

    /// Takes the memory for a picture of this size if it is not held yet. begin() calls it. Throws Error(OutOfMemory).
    void reserve(uint64_t triangles, uint32_t width, uint32_t height);
    /// From now on of this picture, whose camera has no lens (why_no_raster).
    /// Throws Error(OutOfMemory, DeviceFault), and Error(OverLimit) for a scene with too many triangles, or too many in
    /// view.
    void begin(const PictureView& picture);
    const TileRasterView& view() const { return view_; }
    /// Of rays [0, count) of its picture as FindInTiles has them. Queued.
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
