#pragma once

// The film: targets (render/film_target.h) to which samples are added on a device, and the samples of a picture that
// they hold. The picture depends only on the exact sums (render/sum_target.h) and each row's number of samples.

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "base/error.h"
#include "device/buffer.h"
#include "image/image.h"
#include "render/centre_arrays.h"
#include "render/row_samples.h"
#include "render/sum_target.h"

namespace pertev {

class CentreTarget; // render/centre_target.h

/// Ids of the first hit of sample 0 of each pixel.
class IdTarget : public ElementTarget<PixelIds, AddIds, 0xff> { // kNoHit
public:
    using ElementTarget::ElementTarget;
    void show(FilmView& view) const override { view.ids = elements().data(); }
};

/// Number of samples that were not finite or over kMaxSampleValue.
class InvalidTarget : public ElementTarget<uint64_t, AddCounts, 0> {
public:
    using ElementTarget::ElementTarget;
    void show(FilmView& view) const override { view.invalid = elements().data(); }
};

class Film {
public:
    /// Makes a film that starts at zero. `aovs` are AovBits. `light_layers` are the names of the light layers, of three
    /// channels each, that follow them (LightPathView). Samples add nothing to layers at centres.
    Film(Queue& queue, uint32_t width, uint32_t height, uint32_t aovs, std::vector<std::string> light_layers = {},
         LayersAt layers_at = LayersAt::Samples);

    static std::size_t predicted_bytes(uint32_t width, uint32_t height, uint32_t aovs,
                                       std::vector<std::string> light_layers = {},
                                       LayersAt layers_at = LayersAt::Samples);

    /// Adds a target, which is cleared, added and saved with the film's own.
    void hold(std::unique_ptr<FilmTarget> target) { targets_.push_back(std::move(target)); }
    std::span<const std::unique_ptr<FilmTarget>> targets() const { return targets_; }

    FilmView view() const;
    uint32_t width() const { return window_.width; }
    uint32_t height() const { return window_.height; }
    uint32_t aovs() const { return aovs_; }
    LayersAt layers_at() const { return layers_at_; }
    const std::vector<std::string>& light_layers() const { return sums_->light_layers(); }
    const PixelWindow& window() const { return window_; }
    /// The first row of view().
    uint32_t first_row() const { return first_row_; }
    void clear();

    /// Makes the film hold this window, which has its size, of a larger picture. Each pixel gets the bytes that it has
    /// in the whole picture.
    void set_window(const PixelWindow& window) {
        PERTEV_CHECK(window.width == width() && window.height == height());
        PERTEV_CHECK(window.picture_width == 0 || window.x + window.width <= window.picture_width);
        window_ = window;
    }

    /// Lets view() and centres() hold the rows [first, end) alone, so that nothing is added to the others.
    void set_rows(uint32_t first, uint32_t end) {
        PERTEV_CHECK(first < end && end <= height() && (end - first == height() || window_.picture_width == 0));
        first_row_ = first, end_row_ = end;
    }

    /// Makes the film hold the window and the rows of `other`, which has its size.
    void set_place_of(const Film& other) {
        set_window(other.window_);
        set_rows(other.first_row_, other.end_row_);
    }

    /// Sets which samples, of all rows of view(), have been added to it so far.
    void set_samples(SampleRange samples) { set_part({first_row_, end_row_, samples}); }
    void set_part(const FilmPart& part) {
        samples_ = RowSamples(height());
        samples_.add(part);
    }
    /// Returns the samples of a film that has one part, as each film of one render; an empty part without samples.
    /// Throws std::logic_error for several.
    FilmPart part() const;

    /// Sets which samples each row has.
    void set_row_samples(RowSamples samples) { samples_ = std::move(samples); }
    const RowSamples& row_samples() const { return samples_; }

    /// Adds the samples of a film of the same size and targets, from any queue, as if this film had taken them
    /// itself. Ids come from the film that holds sample 0. Throws std::logic_error unless the parts are adjacent:
    /// consecutive samples of the same rows, or consecutive rows of the same samples.
    void add(const Film& other);

    /// Returns the mean of all samples: RGB, or RGBA (colour times coverage, coverage) if `transparent`. Rows without
    /// samples are 0.
    Image picture(bool transparent) const { return sums_->picture(width(), samples_, transparent ? 4 : 3); }
    /// Memory of the film's device for an auxiliary layer.
    struct LayerMemory {
        AovBits group;
        float* to;
    };
    /// Computes picture(), if `picture` is not null, and auxiliary layers of layers(), of the first `pixels` pixels.
    /// The work is queued.
    void resolve_into(float* picture, bool transparent, std::span<const LayerMemory> layers, uint32_t pixels) const;
    /// The arrays of layers at centres with those of ids, for CentreLayers; all null at samples.
    CentreArrays centres() const;
    /// Computes the bytes of tone_map_image(picture(transparent), kind, exposure_stops) on the device and starts
    /// their copy to the host.
    void display(ToneMap kind, float exposure_stops, bool transparent);
    /// The picture from the last display().
    Rgba8Image displayed() const;
    /// Returns the layers in this order: requested auxiliary layers, light layers (RGB), layers of added targets.
    /// Normals, depths and positions are means over the samples that hit something.
    std::vector<FilmLayer> layers() const;
    /// Ids of sample 0, row by row; empty without kAovIds.
    std::vector<PixelIds> ids() const;
    uint64_t invalid_samples() const;

private:
    Queue* queue_;
    PixelWindow window_;
    uint32_t first_row_ = 0, end_row_; // rows that view() holds
    RowSamples samples_;
    std::vector<std::unique_ptr<FilmTarget>> targets_; // the film's own targets below come first
    uint32_t aovs_;
    LayersAt layers_at_;
    const SumTarget* sums_;
    const CentreTarget* centres_ = nullptr; // null without layers at centres
    const IdTarget* ids_ = nullptr;         // null without kAovIds
    const InvalidTarget* invalid_;
    std::unique_ptr<HostCopy> display_; // null before the first display()
};

} // namespace pertev
