#pragma once

// Random numbers of eight paths, drawn at once with the same bits as for each path alone. Host only.

#include "integrators/path/vertex_numbers.h"
#include "math/words8.h"

namespace pertev {

/// Sets the sample of a lane.
template <class Words>
void set_lane(SampleKeyOf<Words>& keys, uint32_t lane, SampleKey key) {
    keys.stream[lane] = key.stream;
    keys.sample[lane] = key.sample;
    keys.seed[lane] = key.seed;
}

/// Numbers of one of eight paths, with the interface that shade_vertex uses (vertex_numbers.h). `lobe` and `roulette`
/// are valid only if the words were drawn with choices.
class DrawnNumbers {
public:
    DrawnNumbers(const VertexWords<Words8>& words, uint32_t lane) : words_(words), lane_(lane) {}

    SampleBits light(const PathSettings&, const PathState&) const {
        return {words_.light.x[lane_], words_.light.y[lane_]};
    }
    Vec2 direction(const PathSettings&, const PathState&) const {
        return {unit_interval(words_.direction.x[lane_]), unit_interval(words_.direction.y[lane_])};
    }
    float lobe(const PathSettings&, const PathState&) const { return unit_interval(words_.choices.x[lane_]); }
    float roulette(const PathSettings&, const PathState&) const { return unit_interval(words_.choices.y[lane_]); }

private:
    const VertexWords<Words8>& words_;
    uint32_t lane_;
};

} // namespace pertev
