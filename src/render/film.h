#pragma once

// The film: exact sums of samples, on a device. The picture is a function of the sums and the number of samples. Means
// and shown pixels are made on the device (render/film_stages.h), into room that the film has held from the start: a
// long render never fails for want of it.

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "device/buffer.h"
#include "image/image.h"
#include "image/tone_map.h"
#include "render/film_view.h"

namespace pertev {

/// One layer of the finished picture: its name, channel names and pixels.
struct FilmLayer {
    std::string name; // as kAovTable names layer and channels
    std::vector<std::string> channels;
    Image image;
};

class Film {
public:
    /// `aovs`: AovBits. `light_layers`: layers of three channels behind these (LightPathView). Starts at zero.
    Film(Queue& queue, uint32_t width, uint32_t height, uint32_t aovs, uint32_t light_layers = 0);

    static std::size_t predicted_bytes(uint32_t width, uint32_t height, uint32_t aovs, uint32_t light_layers = 0);

    FilmView view() const;
    uint32_t width() const { return width_; }
    uint32_t height() const { return height_; }
    uint32_t light_layers() const { return light_layers_; }
    void clear();

    /// Adds the samples of a film of the same size and layers, from any queue: then this one is as if it had taken them
    /// itself. The two hold different samples; ids come from the one that holds sample 0.
    void add(const Film& other);

    /// The mean of `samples` samples a pixel: RGB, or RGBA (colour times coverage, coverage) with `transparent`.
    Image picture(uint64_t samples, bool transparent) const;
    /// The same, made to be shown: the bytes of tone_map_image(picture(samples, transparent), kind, exposure_stops).
    /// Brings it to the host.
    void display(uint64_t samples, ToneMap kind, float exposure_stops, bool transparent);
    /// What the last display() brought.
    Rgba8Image displayed() const;
    /// The auxiliary layers asked for. Normals, depths and positions are means over the samples that hit something.
    std::vector<FilmLayer> layers(uint64_t samples) const;
    /// Light layer `layer`: RGB.
    Image light_layer(uint32_t layer, uint64_t samples) const;
    /// Ids of sample 0, row by row; empty without kAovIds.
    std::vector<PixelIds> ids() const { return ids_.download(); }
    uint64_t invalid_samples() const { return invalid_.download()[0]; }

private:
    uint32_t pixel_count() const { return width_ * height_; }
    Image resolve(uint32_t first, uint32_t channels, bool over_hits, uint64_t samples) const;

    Queue* queue_;
    uint32_t width_, height_, aovs_, light_layers_, channels_;
    Buffer<FixedSum> sums_;
    Buffer<PixelIds> ids_;
    Buffer<uint64_t> invalid_;
    Buffer<float> resolved_; // kFilmColorChannels a pixel: what a picture, a layer or a display takes at most
    std::unique_ptr<HostCopy> display_; // none before it is asked for
};

} // namespace pertev
