#pragma once

// A frame in real time leaves a history for the next one. Here it is on the host, so that another process can go on
// with the sequence (session/film_file/history_file.h).

#include <cstddef>
#include <cstdint>
#include <vector>

#include "scene/camera.h"

namespace pertev {

struct FrameHistory {
    uint32_t number = 0;         // sample that the frame took
    Camera camera;               // camera of the frame
    bool has_reservoirs = false; // whether ReSTIR has some
    bool has_light = false;      // whether there is a small picture of the frame's scene, because that was moving
    std::vector<std::vector<std::byte>> arrays;
};

} // namespace pertev
