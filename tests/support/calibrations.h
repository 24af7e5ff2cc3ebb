#pragma once

// Calibrated cameras of 1280x720 pixels, and the pixels to which OpenCV 5.0 projects six points (cv2.projectPoints,
// cv2.fisheye.projectPoints, with y and z converted to its axes).

#include <vector>

#include "scene/camera.h"

namespace pertev::test {

struct Calibration {
    const char* name;
    LensModel lens;
    std::vector<double> distortion;
    double focal_x, focal_y;
    Vec2 seen[6]; // positions of kPoints in the picture
};

inline constexpr Vec3 kPoints[] = {{0.1f, 0.2f, -2},      {0.5f, -0.4f, -1.5f}, {-0.6f, 0.3f, -1.2f},
                                   {-0.2f, -0.5f, -3.0f}, {0.9f, 0.5f, -2.5f},  {0, 0, -1}};

inline const Calibration kCalibrations[] = {
    {"four coefficients",
     LensModel::OpenCv,
     {-0.28, 0.07, 0.001, -0.0005},
     900,
     990,
     {{694.826117f, 251.382542f},
      {935.368637f, 601.376961f},
      {236.158203f, 122.77373f},
      {590.498473f, 513.621225f},
      {958.943699f, 161.322337f},
      {650, 350}}},
    {"five coefficients",
     LensModel::OpenCv,
     {-0.28, 0.07, 0.001, -0.0005, 0.02},
     900,
     990,
     {{694.826119f, 251.382538f},
      {935.404941f, 601.408908f},
      {235.883545f, 122.622668f},
      {590.498432f, 513.621336f},
      {958.975311f, 161.303018f},
      {650, 350}}},
    {"eight coefficients",
     LensModel::OpenCv,
     {0.5, -0.2, 1e-3, 2e-3, 0.01, 0.9, -0.1, 0.02},
     900,
     990,
     {{694.799303f, 251.503407f},
      {931.176631f, 597.327196f},
      {249.468423f, 129.707633f},
      {590.811688f, 512.959257f},
      {954.702507f, 164.147377f},
      {650, 350}}},
    {"fisheye",
     LensModel::Fisheye,
     {-0.02, 0.005, -0.003, 0.0005},
     400,
     440,
     {{669.912363f, 306.192801f},
      {775.623852f, 460.54899f},
      {468.525328f, 250.188931f},
      {623.630859f, 422.515138f},
      {786.196432f, 266.768847f},
      {650, 350}}},
    {"fisheye that turns back",
     LensModel::Fisheye,
     {0.1, -0.05, 0.02, -0.004},
     400,
     440,
     {{669.941825f, 306.127985f},
      {777.913881f, 462.564215f},
      {463.446353f, 247.395494f},
      {623.532398f, 422.785904f},
      {788.533915f, 265.340386f},
      {650, 350}}},
};

inline Camera camera_of(const Calibration& calibration) {
    Camera camera;
    camera.intrinsics = Intrinsics{calibration.focal_x, calibration.focal_y, 650, 350, 1280, 720};
    camera.lens = calibration.lens;
    camera.distortion = calibration.distortion;
    return camera;
}

} // namespace pertev::test
