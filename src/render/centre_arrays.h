#pragma once

// Where layers at the centres of pixels lie (render/centre_layers.h).

#include "render/film_view.h"

namespace pertev {

/// Arrays of the layers of a window, one element per channel of each slot; null for those that are not wanted.
struct CentreArrays {
    float *albedo = nullptr, *normal = nullptr, *depth = nullptr, *position = nullptr, *distance = nullptr;
    PixelIds* ids = nullptr;

    /// The array of a group of sums.
    float*& of(AovBits group);
};

} // namespace pertev
