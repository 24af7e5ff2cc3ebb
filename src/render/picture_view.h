#pragma once

// A scene as a camera sees it, which samples are taken from. It consists of views and numbers; whoever begins a
// picture owns the memory.

#include "device_scene/scene_view.h"
#include "render/camera_rays.h"

namespace pertev {

struct PictureView {
    SceneView scene;
    CameraRays camera;
    bool hide_background = false; // camera rays that hit nothing return black, for pictures with alpha

    /// Returns whether a camera ray from `origin` that hits nothing is black.
    HD bool hides_background(Vec3 origin) const { return hide_background || is_nowhere(origin); }
};

} // namespace pertev
