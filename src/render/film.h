#pragma once

// The film: targets (render/film_target.h) that samples are added to, on a device, and what part of a picture they
// hold. The picture is a function of the exact sums and the number of samples. Means and shown pixels are made on the
// device (render/film_stages.h), into room that the film has held from the start: a long render never fails for want of
// it.

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "base/error.h"
#include "device/buffer.h"
#include "image/image.h"
#include "image/tone_map.h"
#include "render/film_stages.h"
#include "render/film_target.h"

namespace pertev {

/// Exact sums of the channels of render/film_channels.h.
class SumTarget : public ElementTarget<FixedSum, AddSums, 0> {
public:
    using ElementTarget::ElementTarget;
    void show(FilmView& view) const override { view.sums = elements().data(); }
};

/// What sample 0 of each pixel hit first.
class IdTarget : public ElementTarget<PixelIds, AddIds, 0xff> { // kNoHit
public:
    using ElementTarget::ElementTarget;
    void show(FilmView& view) const override { view.ids = elements().data(); }
};

/// One count of samples that were not finite or over kMaxSampleValue.
class InvalidTarget : public ElementTarget<uint64_t, AddCounts, 0> {
public:
    using ElementTarget::ElementTarget;
    void show(FilmView& view) const override { view.invalid = elements().data(); }
};

/// Samples [first, end) of each pixel.
struct SampleRange {
    uint32_t first = 0, end = 0;
    uint32_t count() const { return end - first; }
    bool operator==(const SampleRange&) const = default;
};

/// A part of a picture: samples of each pixel of the rows [first_row, end_row).
struct FilmPart {
    uint32_t first_row = 0, end_row = 0;
    SampleRange samples;
    bool is_empty() const { return first_row == end_row || samples.count() == 0; }
    bool operator==(const FilmPart&) const = default;
};

class Film {
public:
    /// `aovs`: AovBits. `light_layers`: names of layers of three channels behind these (LightPathView). Starts at zero.
    Film(Queue& queue, uint32_t width, uint32_t height, uint32_t aovs, std::vector<std::string> light_layers = {});

    static std::size_t predicted_bytes(uint32_t width, uint32_t height, uint32_t aovs,
                                       std::vector<std::string> light_layers = {});

    /// Adds a target. It is cleared, added and kept with the film's own.
    void hold(std::unique_ptr<FilmTarget> target) { targets_.push_back(std::move(target)); }
    std::span<const std::unique_ptr<FilmTarget>> targets() const { return targets_; }

    FilmView view() const;
    uint32_t width() const { return width_; }
    uint32_t height() const { return height_; }
    uint32_t aovs() const { return aovs_; }
    const std::vector<std::string>& light_layers() const { return light_layers_; }
    void clear();

    /// From now on the film is of this window of the picture. Of integrators, `path`, `direct`, `indirect` and `hybrid`
    /// render windows; the others throw std::logic_error.
    void set_window(const PixelWindow& window) {
        PERTEV_CHECK(window.picture_width == 0 ||
                     (window.width == width_ && window.x + window.width <= window.picture_width));
        window_ = window;
    }

    /// Says what the samples are that have been added to view() until now: of all rows.
    void set_samples(SampleRange samples) { set_part({0, height_, samples}); }
    void set_part(FilmPart part) { part_ = part; }
    const FilmPart& part() const { return part_; }

    /// Adds the samples of a film of the same size and targets, from any queue: then this one is as if it had taken
    /// them itself. Ids come from the one that holds sample 0. Throws std::logic_error unless the two parts make one:
    /// other samples of the same rows, or the same samples of other rows, that follow each other.
    void add(const Film& other);

    /// The means of all samples: RGB, or RGBA (colour times coverage, coverage) with `transparent`.
    Image picture(bool transparent) const;
    /// Makes the picture's bytes for a display: those of tone_map_image(picture(transparent), kind, exposure_stops).
    /// Brings it to the host.
    void display(ToneMap kind, float exposure_stops, bool transparent);
    /// What the last display() brought.
    Rgba8Image displayed() const;
    /// The auxiliary layers asked for, then the light layers (RGB), then those of targets that it was given. Normals,
    /// depths and positions are means over the samples that hit something.
    std::vector<FilmLayer> layers() const;
    /// Ids of sample 0, row by row; empty without kAovIds.
    std::vector<PixelIds> ids() const;
    uint64_t invalid_samples() const;

private:
    uint32_t pixel_count() const { return width_ * height_; }
    Image resolve(uint32_t first, uint32_t channels, bool over_hits) const;

    Queue* queue_;
    uint32_t width_, height_, aovs_;
    std::vector<std::string> light_layers_;
    uint32_t channels_;
    PixelWindow window_;
    FilmPart part_;
    std::vector<std::unique_ptr<FilmTarget>> targets_; // the first of them those below
    const SumTarget* sums_;
    const IdTarget* ids_ = nullptr; // none without kAovIds
    const InvalidTarget* invalid_;
    Buffer<float> resolved_; // kFilmColorChannels a pixel: what a picture, a layer or a display takes at most
    std::unique_ptr<HostCopy> display_; // none before it is asked for
};

} // namespace pertev
