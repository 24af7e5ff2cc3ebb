#pragma once

// Pictures of one size that are rendered together as one tall picture: its pixel p is pixel p % pixels of picture
// p / pixels. A picture's camera and seed are chosen by its number, and its random numbers are those of the pixel
// within it, so it has the bytes that it has alone.

#include "math/sampler.h"
#include "render/camera_rays.h"

namespace pertev {

struct BatchView {
    const CameraRays* cameras = nullptr; // one per picture; null if the picture is not tall
    const uint32_t* seeds = nullptr;     // one per picture
    uint32_t pixels = 0;                 // number of pixels of one picture

    /// A pixel of one of the pictures.
    struct PixelOfPicture {
        uint32_t picture, pixel;
    };

    HD bool is_there() const { return cameras != nullptr; }
    HD PixelOfPicture pixel_of(uint32_t tall_pixel) const {
        const uint32_t picture = tall_pixel / pixels;
        return {picture, tall_pixel - picture * pixels};
    }
    HD const CameraRays& camera_of(uint32_t tall_pixel) const { return cameras[tall_pixel / pixels]; }
    /// Returns the key of a sample's random numbers.
    HD SampleKey key(uint32_t tall_pixel, uint32_t sample) const {
        const PixelOfPicture at = pixel_of(tall_pixel);
        return {at.pixel, sample, seeds[at.picture]};
    }
};

} // namespace pertev
