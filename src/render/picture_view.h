#pragma once

// What samples are taken of: a scene, seen by a camera. Views and numbers; whoever begins a picture keeps what they
// point to.

#include "device_scene/scene_view.h"
#include "render/camera_rays.h"

namespace pertev {

struct PictureView {
    SceneView scene;
    CameraRays camera;
    bool hide_background = false; // a camera ray that hits nothing brings nothing: for pictures with alpha
};

} // namespace pertev
