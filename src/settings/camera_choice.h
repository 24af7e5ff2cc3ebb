#pragma once

// Requested properties of a camera, from which session/opening/choose_camera.h makes one. Messages use the names of
// the fields.

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "math/double_vec3.h"
#include "math/vec3.h"
#include "scene/camera.h"

namespace pertev {

struct PictureSize {
    uint32_t width = 0, height = 0; // pixels
    bool operator==(const PictureSize&) const = default;
};

/// Axes of a camera's pose. OpenGl: x to the right, y up, it looks along -z, as Camera does. OpenCv: x to the right, y
/// down, it looks along z. Blender: as OpenGl, in a world with z up.
enum class PoseConvention : uint8_t { OpenGl, OpenCv, Blender };

struct CameraChoice {
    std::string camera;                    // name or number, from 0, of a camera of the scene; "": the first
    std::optional<DoubleVec3> eye, target; // metres, in the coordinates of the file
    std::optional<Vec3> up;
    bool is_aimed = false;         // whether aim_camera() has set the target
    std::optional<float> fov_deg;  // full vertical field of view, degrees
    std::optional<float> aperture; // radius of the lens, metres
    std::optional<uint32_t> aperture_blades;
    std::optional<float> aperture_rotation; // degrees
    std::optional<float> aperture_ratio;
    std::optional<float> focus; // focus distance, metres
    std::optional<Projection> projection;
    std::optional<float> view_height; // full height of an orthographic view, metres
    std::vector<double> pose;         // world from camera, 16 or 12 numbers by rows, in the coordinates of the file
    std::optional<PoseConvention> convention;
    std::vector<double> intrinsics; // focal lengths and principal point, or K by rows, pixels
    std::optional<PictureSize> intrinsics_size;
    std::optional<LensModel> lens; // not Straight
    std::vector<double> distortion;
    double eye_offset = 0;             // metres to the camera's right
    std::optional<double> convergence; // metres along the view to where pictures of all offsets coincide
    std::string camera_from;           // an EXR with the metadata of a camera
    std::optional<float> fov_y;        // radians, of that camera; degrees need not give them to the bit

    /// Returns whether the choice places the camera elsewhere than the scene's own.
    bool places_camera() const { return eye || !pose.empty() || !camera_from.empty(); }
};

} // namespace pertev
