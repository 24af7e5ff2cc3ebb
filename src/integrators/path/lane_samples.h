#pragma once

// Starts eight or sixteen paths at once (generate_path.h starts one). Host only.

#include "integrators/path/drawn_numbers.h"
#include "integrators/path/generate_path.h"
#include "math/lanes.h"

namespace pertev {

/// Samples whose paths are to begin, up to as many as `Floats`, Floats8 or Floats16, has lanes.
template <class Floats>
class LaneSamples {
    static constexpr uint32_t kLanes = Floats::kLanes;
    using Words = WordOf<Floats>;

public:
    /// `aims` are those of NoisyFrameView.
    LaneSamples(const CameraRays& camera, const PathSettings& settings, const BatchView& batch = {},
                const Float4* aims = nullptr)
        : camera_(&camera), settings_(settings), batch_(batch), aims_(aims) {}

    bool is_full() const { return count_ == kLanes; }
    /// Returns whether the pixel is in the same picture of a batch as the samples so far.
    bool can_add(uint32_t pixel) const {
        return count_ == 0 || !batch_.is_there() || &batch_.camera_of(pixel) == camera_;
    }
    void add(uint32_t pixel, uint32_t sample) {
        SampleKey key = sample_key(settings_, pixel, sample);
        if (batch_.is_there()) {
            key = batch_.key(pixel, sample);
            camera_ = &batch_.camera_of(pixel);
        }
        set_lane(keys_, count_, key);
        const Vec2 corner = camera_->corner_of(key.stream);
        corners_x_[count_] = corner.x, corners_y_[count_] = corner.y;
        pixels_[count_++] = pixel;
    }

    /// Passes to `take` a function that makes each path, in the order in which they were added, and becomes empty. A
    /// path is thus made where it is kept: a copy of one just made waits for its stores.
    template <class Take>
    void begin(const Take& take) {
        alignas(64) float rows[kLanes][8];
        store_lines(rows);
        Words times = {};
        static_assert(kNumberTime == 2);
        if (camera_->is_open) times = draw(kGroupLens, Pair::Last).x;
        for (uint32_t i = 0; i < count_; ++i) {
            const float time = camera_->is_open ? unit_interval(times[i]) : kAtRest;
            const float* const row = rows[i];
            const Ray through = camera_->ray({{row[0], row[1], row[2]}, {row[3], row[4], row[5]}}, time),
                      ray = aimed_ray(*camera_, aims_, pixels_[i], through);
            take([&] { return begin_path(*camera_, pixels_[i], keys_.sample[i], ray, time); });
        }
        count_ = 0;
    }

private:
    SampleBitsOf<Words> draw(CameraGroup group, Pair pair = Pair::First) const {
        return sample_bits<Words>(settings_.sampler, keys_, Words{} + uint32_t{group}, pair);
    }
    static Vec2Of<Floats> unit_square(const SampleBitsOf<Words>& bits) {
        return {unit_interval<Floats>(bits.x), unit_interval<Floats>(bits.y)};
    }

    /// Stores origins and directions of the camera's rays, before its motion, in rows.
    void store_lines(float (&rows)[kLanes][8]) const {
        const Vec2Of<Floats> corners = {Floats::load(corners_x_), Floats::load(corners_y_)};
        Vec2Of<Floats> on_lens = {0.0f, 0.0f};
        if (camera_->has_lens()) on_lens = unit_square(draw(kGroupLens));
        const RayLineOf<Floats> line = camera_->line(corners, unit_square(draw(kGroupCamera)), on_lens);
        const Vec3Of<Floats>&from = line.origin, &to = line.direction;
        std::array<float*, kLanes> to_rows;
        for (uint32_t lane = 0; lane < kLanes; ++lane) to_rows[lane] = rows[lane];
        store_columns({from.x, from.y, from.z, to.x, to.y, to.z, to.z, to.z}, to_rows);
    }

    const CameraRays* camera_; // the camera of all lanes
    const PathSettings& settings_;
    const BatchView batch_;
    const Float4* const aims_;
    SampleKeyOf<Words> keys_; // lanes beyond `count_` hold previous samples or 0, whose rays are not used
    float corners_x_[kLanes] = {}, corners_y_[kLanes] = {};
    uint32_t pixels_[kLanes];
    uint32_t count_ = 0;
};

} // namespace pertev
