#pragma once

// Owns the arrays of a NoisyFrameView. Its film view takes samples in place of a film and holds one sample per pixel,
// the last one. It is a target (render/film_target.h), so that frames whose pixels were rendered separately can be
// combined. A film does not hold it together with its own targets.

#include "device/buffer.h"
#include "render/film_target.h"
#include "render/row_exchange.h"

namespace pertev {

class NoisyFrame : public FilmTarget {
public:
    /// Makes a frame. `splits_light` means that the scene has surfaces with lobes other than diffuse ones.
    NoisyFrame(Queue& queue, uint32_t width, uint32_t height, bool splits_light);
    /// Makes a frame in another owner's memory: arrays(splits_light) elements per pixel from `numbers` on.
    NoisyFrame(Queue& queue, uint32_t width, uint32_t height, bool splits_light, Float4* numbers);
    static constexpr std::size_t arrays(bool splits_light) { return splits_light ? 7 : 6; }
    /// Sets the arrays in which samples leave their first bounce for ReSTIR from now on.
    void leave(const FirstBounceView& first_bounce) { view_.first_bounce = first_bounce; }
    /// Sets the arrays in which samples store their mirrors from now on. The frame splits its light.
    void follow(const MirrorChainView& mirrors) { view_.mirrors = mirrors; }
    /// Sets the points to which camera rays go from now on (NoisyFrameView::aims); null: none.
    void aim(const Float4* points) { view_.aims = points; }

    const char* name() const override { return "noisy frame"; }
    /// Clears the frame, which is necessary only for parts of a frame; in a whole frame the next sample overwrites each
    /// pixel.
    void clear() override;
    void show(FilmView& view) const override;
    bool is_like(const FilmTarget& other) const override;
    /// Takes the pixels that have had no sample here since clear(), which must have been called.
    void add(const FilmTarget& other) override;
    std::size_t byte_count() const override { return count() * sizeof(Float4) + sizeof(uint64_t); }
    std::size_t stride() const override { return byte_count(); } // it is read and added as a whole
    void read(std::size_t first, std::span<std::byte> to) const override;
    void add_bytes(std::size_t first, std::span<const std::byte> from) override;

    /// The film view to which an integrator adds samples.
    FilmView film_view() const;
    /// The film view of some rows, at least one.
    FilmView film_view(RowBand rows) const;
    /// The frame's arrays by rows, for other devices.
    std::vector<RowArray> rows() const;
    const NoisyFrameView& view() const { return view_; }
    uint32_t width() const { return width_; }
    uint32_t height() const { return height_; }
    bool splits_light() const { return view_.splits_light(); }
    /// Number of samples of the current frame that were not finite or over kMaxSampleValue.
    uint64_t invalid_samples() const { return invalid_.download()[0]; }
    /// Resets the count of invalid samples; the next samples overwrite everything else.
    void begin() { invalid_.zero(); }

private:
    NoisyFrame(Queue& queue, uint32_t width, uint32_t height, bool splits_light, Buffer<Float4> own);

    std::size_t count() const { return std::size_t(width_) * height_ * arrays(splits_light()); }

    Queue* queue_;
    uint32_t width_, height_;
    Buffer<Float4> numbers_; // empty if another owner's memory is used
    Buffer<uint64_t> invalid_;
    NoisyFrameView view_;
};

} // namespace pertev
