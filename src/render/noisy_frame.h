#pragma once

// Owns the arrays of a NoisyFrameView. A film view of it takes samples in a film's place; it holds one sample a pixel,
// the last one. It is a target (render/film_target.h), so that frames whose pixels were taken apart are put together. A
// film does not hold it beside its own targets.

#include "device/buffer.h"
#include "render/film_target.h"

namespace pertev {

class NoisyFrame : public FilmTarget {
public:
    /// `splits_light`: the scene has surfaces that scatter by other than diffuse lobes.
    NoisyFrame(Queue& queue, uint32_t width, uint32_t height, bool splits_light);
    /// In memory of another's: arrays(splits_light) numbers a pixel from `numbers` on.
    NoisyFrame(Queue& queue, uint32_t width, uint32_t height, bool splits_light, Float4* numbers);
    static constexpr std::size_t arrays(bool splits_light) { return splits_light ? 7 : 6; }
    /// What its samples leave to another, whose arrays these are, from now on.
    void leave(const FirstBounceView& first_bounce) { view_.first_bounce = first_bounce; }

    const char* name() const override { return "noisy frame"; }
    /// Only parts of a frame need it: a whole one is written by the next sample of each pixel.
    void clear() override;
    void show(FilmView& view) const override;
    bool is_like(const FilmTarget& other) const override;
    /// Takes the pixels that this one has had no sample of since it was cleared, which it has been before.
    void add(const FilmTarget& other) override;
    std::vector<std::byte> bytes() const override;
    void set_bytes(std::span<const std::byte> bytes) override;

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

    std::size_t count() const { return std::size_t(width_) * height_ * arrays(splits_light()); }

    Queue* queue_;
    uint32_t width_, height_;
    Buffer<Float4> numbers_; // empty where they lie in another's memory
    Buffer<uint64_t> invalid_;
    NoisyFrameView view_;
};

} // namespace pertev
