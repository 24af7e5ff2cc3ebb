#pragma once

// Starts eight paths at once (generate_path.h starts one). Host only.

#include "integrators/path/drawn_numbers.h"
#include "integrators/path/generate_path.h"

namespace pertev {

/// Up to eight samples whose paths are to begin.
class EightSamples {
public:
    EightSamples(const CameraRays& camera, const PathSettings& settings) : camera_(camera), settings_(settings) {}

    bool is_full() const { return count_ == kWords; }
    void add(uint32_t pixel, uint32_t sample) {
        set_lane(keys_, count_, sample_key(settings_, pixel, sample));
        pixels_[count_++] = pixel;
    }

    /// Passes each path to `take`, in the order in which they were added, and becomes empty.
    template <class Take>
    void begin(const Take& take) {
        const SamplerKind kind = settings_.sampler;
        SampleBitsOf<Words8> on_lens = {};
        Words8 times = {};
        const auto in_filter = sample_bits<Words8>(kind, keys_, Words8{} + uint32_t{kGroupCamera});
        if (camera_.has_lens()) on_lens = sample_bits<Words8>(kind, keys_, Words8{} + uint32_t{kGroupLens});
        static_assert(kNumberTime == 2);
        if (camera_.is_open) times = sample_bits<Words8>(kind, keys_, Words8{} + uint32_t{kGroupLens}, Pair::Last).x;
        for (uint32_t i = 0; i < count_; ++i) {
            const float time = camera_.is_open ? unit_interval(times[i]) : kAtRest;
            const Vec2 lens = camera_.has_lens() ? unit_square(on_lens, i) : Vec2{};
            const Ray ray = camera_.ray(pixels_[i], unit_square(in_filter, i), lens, time);
            take(begin_path(camera_, pixels_[i], keys_.sample[i], ray, time));
        }
        count_ = 0;
    }

private:
    const CameraRays& camera_;
    const PathSettings& settings_;
    SampleKeyOf<Words8> keys_; // lanes beyond `count_` hold previous samples or 0, whose numbers are not used
    uint32_t pixels_[kWords];
    uint32_t count_ = 0;
};

} // namespace pertev
