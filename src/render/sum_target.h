#pragma once

// The target of exact sums: colour, hits, auxiliary channels and light layers of each pixel, in the order of
// render/film_channels.h. Means and displayed pixels are computed on the device (render/film_stages.h) in memory that
// is allocated from the start, so a long render never fails because of it.

#include <span>

#include "image/tone_map.h"
#include "render/film_stages.h"
#include "render/film_target.h"

namespace pertev {

class SumTarget final : public ElementTarget<FixedSum, AddSums, 0> {
public:
    /// `aovs` are AovBits; `light_layers` are the names of layers of three channels each.
    SumTarget(Queue& queue, std::size_t pixels, uint32_t aovs, std::vector<std::string> light_layers);

    void show(FilmView& view) const override;
    bool is_like(const FilmTarget& other) const override;
    std::size_t stride() const override { return channels_ * sizeof(FixedSum); }
    /// Returns the auxiliary layers, then the light layers.
    std::vector<FilmLayer> layers(uint32_t width, const RowSamples& samples) const override;

    /// Returns the means of the first `channels` channels.
    Image picture(uint32_t width, const RowSamples& samples, uint32_t channels) const {
        return resolve(width, samples, {0, channels, false});
    }
    /// Computes the bytes of Film::display, four per pixel, and returns where they lie on the device.
    const void* display(uint32_t width, const RowSamples& samples, ToneMap kind, float exposure_stops,
                        bool transparent) const;

    /// Computes means of the first `pixels` pixels on the device, ResolveFilm::kMost of them at most.
    void resolve_into(std::span<const FilmMeans> means, uint32_t width, uint32_t pixels,
                      const RowSamples& samples) const;

    uint32_t aovs() const { return aovs_; }
    const std::vector<std::string>& light_layers() const { return light_layers_; }

private:
    Image resolve(uint32_t width, const RowSamples& samples, FilmMeans means) const;
    /// Returns the view of the pixels from number `first` on.
    FilmView view_from(std::size_t first) const {
        FilmView view = {};
        show(view);
        view.sums += first * channels_;
        return view;
    }

    uint32_t pixels_, aovs_, channels_;
    std::vector<std::string> light_layers_;
    Buffer<float> resolved_; // kFilmColorChannels per pixel, the most that a picture, a layer or a display needs
};

} // namespace pertev
