#pragma once

// Owns the arrays of a NoisyFrameView. A film view of it takes samples in a film's place; it holds one sample a pixel,
// the last one.

#include "device/buffer.h"
#include "render/film_view.h"

namespace pertev {

class NoisyFrame {
public:
    /// `splits_light`: the scene has surfaces that scatter by other than diffuse lobes.
    NoisyFrame(Queue& queue, uint32_t width, uint32_t height, bool splits_light);
    /// In memory of another's: arrays(splits_light) numbers a pixel from `numbers` on.
    NoisyFrame(Queue& queue, uint32_t width, uint32_t height, bool splits_light, Float4* numbers);
    static constexpr std::size_t arrays(bool splits_light) { return splits_light ? 7 : 6; }
    /// What its samples leave to another, whose arrays these are, from now on.
    void leave(const FirstBounceView& first_bounce) { view_.first_bounce = first_bounce; }

    /// What an integrator adds a sample to.
    FilmView film_view() const;
    const NoisyFrameView& view() const { return view_; }
    uint32_t width() const { return width_; }
    uint32_t height() const { return height_; }
    bool splits_light() const { return view_.splits_light(); }
    /// Samples of the present frame that were not finite or over kMaxSampleValue.
    uint64_t invalid_samples() const { return invalid_.download()[0]; }
    /// Forgets invalid samples; every other number is written by the next sample.
    void begin() { invalid_.zero(); }

private:
    NoisyFrame(Queue& queue, uint32_t width, uint32_t height, bool splits_light, Buffer<Float4> own);

    uint32_t width_, height_;
    Buffer<Float4> numbers_; // empty where they lie in another's memory
    Buffer<uint64_t> invalid_;
    NoisyFrameView view_;
};

} // namespace pertev
