#pragma once

// Purpose for which a scene is opened. It decides which light is added if a file lacks it.

namespace pertev {

enum class SceneUse {
    Picture,     // `render`, `view`: adds a sky if the file has too little light to see by
    Measurement, // `measure`, `solve` and pictures of solutions: adds a sky if the file has no light at all
    Benchmark,   // `bench` and `lab`: like Measurement, with the sky under which recorded figures were measured
};

} // namespace pertev
