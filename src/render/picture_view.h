#pragma once

// A scene as a camera sees it, which samples are taken from. It consists of views and numbers; whoever begins a
// picture owns the memory.

#include "device_scene/scene_view.h"
#include "render/batch_view.h"

namespace pertev {

struct PictureView {
    SceneView scene;
    CameraRays camera;
    bool hide_background = false; // camera rays that hit nothing return black, for pictures with alpha
    BatchView batch = {};         // if it is there, `camera` has the size of the tall picture and no place

    /// Returns the scene that a pixel's picture shows. Pictures of a batch have one scene; worlds that differ are to be
    /// chosen here, by the number of the picture (BatchView::pixel_of).
    HD const SceneView& scene_of(uint32_t) const { return scene; }
    /// Returns whether a camera ray from `origin` that hits nothing is black.
    HD bool hides_background(Vec3 origin) const { return hide_background || is_outside_lens(origin); }
    /// The camera's axis for a pixel at a ray's time.
    HD Vec3 axis_at(uint32_t pixel, float time) const {
        if (!batch.is_there()) return camera.axis_at(time);
        return batch.camera_of(pixel).axis_at(time);
    }
};

} // namespace pertev
