#pragma once

// What a scene is opened for. It decides what may be made up where a file lacks light.

namespace pertev {

enum class SceneUse {
    Picture,     // `render`, `view`: a sky where the file has too little light to see by
    Measurement, // `measure`, `solve` and pictures of what was solved: a sky where the file has no emitter at all
    Benchmark,   // `bench` and `lab`: as Measurement, under the sky that recorded figures were measured under
};

} // namespace pertev
