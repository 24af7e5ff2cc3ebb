#pragma once

// What a scene is opened for. It decides what may be made up where a file lacks light.

namespace pertev {

enum class SceneUse {
    Picture,     // `render`, `view`, `solve`, whose light pictures show: a sky where it has too little light to see by
    Measurement, // `measure`: a sky where the file has no emitter at all
    Benchmark,   // `bench` and `lab`: as Measurement, under the sky that recorded figures were measured under
};

} // namespace pertev
