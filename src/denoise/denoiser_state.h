#pragma once

// A denoiser gathers numbers of each pixel. Here they are words of 32 bits that do not depend on the device, so that
// parts of a picture's rows can be saved, added up and denoised as a whole. The words of a pixel that another part has
// gathered are missing.

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <utility>
#include <vector>

#include "device/queue.h"
#include "render/camera_view.h"
#include "render/film_target.h"

namespace pertev {

using DenoiserState = std::vector<uint32_t>; // empty: nothing was gathered
inline constexpr uint32_t kMissingWord = 0xffffffffu;

/// The number of words of a denoiser's state. The last ones, `sums`, are sums of samples: whole numbers of 64 bits, the
/// low half first, which parts with other samples add to. They are 0 where the part has no sample.
struct DenoiserStateSize {
    std::size_t words = 0, sums = 0;
};

/// The words that all parts have in common. They precede those of pixels.
struct DenoiserHead {
    static constexpr std::size_t kWords = 32;

    uint32_t samples = 0, features = 0;
    bool has_gloss = false;
    CameraView camera = {}; // without its lens

    void write(std::span<uint32_t> words) const;
    /// Throws Error(BadInput) for any other words.
    static DenoiserHead read(std::span<const uint32_t> words);
};

/// An array on a device with a number of words for each pixel.
struct PixelWords {
    void* data;
    std::size_t words; // per pixel
};
/// Copies the pixels [first, first + count) of arrays of `pixels` pixels, one array after the other, to their places in
/// `to`.
void save_pixels(Queue& queue, std::span<const PixelWords> arrays, std::size_t pixels, std::size_t first,
                 std::size_t count, std::span<uint32_t> to);
/// Copies these pixels back from their places in `from`.
void restore_pixels(Queue& queue, std::span<const PixelWords> arrays, std::size_t pixels, std::size_t first,
                    std::size_t count, std::span<const uint32_t> from);

/// The target of a denoised film: the state of its denoiser, on the host.
class DenoiserTarget final : public FilmTarget {
public:
    /// Makes a target of this size. While it is read, `now`, if it is not empty, gives the state.
    explicit DenoiserTarget(DenoiserStateSize size, std::function<DenoiserState()> now = {})
        : count_(size.words), sums_from_(size.words - size.sums), now_(std::move(now)) {}

    /// Returns the words that were added, and takes them out of the target.
    DenoiserState take() { return std::exchange(words_, {}); }

    const char* name() const override { return "denoiser"; }
    void clear() override { words_ = {}; }
    void show(FilmView&) const override {}
    bool is_like(const FilmTarget& other) const override;
    /// Takes the words that are missing here, and adds the sums.
    void add(const FilmTarget& other) override;
    std::size_t byte_count() const override { return count_ * sizeof(uint32_t); }
    std::size_t stride() const override { return sizeof(uint32_t); }
    void read(std::size_t first, std::span<std::byte> to) const override;
    void add_bytes(std::size_t first, std::span<const std::byte> from) override;

private:
    void fill_missing(std::size_t first, std::span<uint32_t> to) const;

    std::size_t count_, sums_from_;
    std::function<DenoiserState()> now_;
    DenoiserState words_;        // empty: all are missing
    mutable DenoiserState read_; // The state while it is read.
};

} // namespace pertev
