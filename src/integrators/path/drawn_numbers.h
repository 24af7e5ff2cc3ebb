#pragma once

// Random numbers of eight paths, drawn at once. Host only; the same bits as each path draws by itself.

#include "integrators/path/vertex_numbers.h"
#include "math/words8.h"

namespace pertev {

/// The sample of one lane out of eight.
inline void set_lane(SampleKeyOf<Words8>& keys, uint32_t lane, SampleKey key) {
    keys.pixel[lane] = key.pixel;
    keys.sample[lane] = key.sample;
    keys.seed = key.seed;
}

inline Vec2 unit_square(const SampleBitsOf<Words8>& bits, uint32_t lane) {
    return {unit_interval(bits.x[lane]), unit_interval(bits.y[lane])};
}

/// Of one path out of eight, as shade_vertex asks for them (vertex_numbers.h). `lobe` and `roulette` are only of words
/// that were drawn with choices.
class DrawnNumbers {
public:
    DrawnNumbers(const VertexWords<Words8>& words, uint32_t lane) : words_(words), lane_(lane) {}

    SampleBits light(const PathSettings&, const PathState&) const {
        return {words_.light.x[lane_], words_.light.y[lane_]};
    }
    Vec2 direction(const PathSettings&, const PathState&) const { return unit_square(words_.direction, lane_); }
    float lobe(const PathSettings&, const PathState&) const { return unit_interval(words_.choices.x[lane_]); }
    float roulette(const PathSettings&, const PathState&) const { return unit_interval(words_.choices.y[lane_]); }

private:
    const VertexWords<Words8>& words_;
    uint32_t lane_;
};

} // namespace pertev
