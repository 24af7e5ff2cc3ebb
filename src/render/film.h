#pragma once

// The film: exact sums of samples, on a device. The picture is a function of the sums and the number of samples.

#include <cstdint>
#include <string>
#include <vector>

#include "device/buffer.h"
#include "image/image.h"
#include "render/film_view.h"

namespace pertev {

/// One layer of the finished picture: its name, channel names and pixels.
struct FilmLayer {
    std::string name;                  // "albedo", "normal", "depth", "position"
    std::vector<std::string> channels; // "R" "G" "B", "X" "Y" "Z", "Z"
    Image image;
};

class Film {
public:
    /// `aovs`: AovBits. Starts at zero.
    Film(Queue& queue, uint32_t width, uint32_t height, uint32_t aovs);

    static std::size_t predicted_bytes(uint32_t width, uint32_t height, uint32_t aovs);

    FilmView view() const;
    uint32_t width() const { return width_; }
    uint32_t height() const { return height_; }
    void clear();

    /// The mean of `samples` samples a pixel: RGB, or RGBA (colour times coverage, coverage) with `transparent`.
    Image picture(uint64_t samples, bool transparent) const;
    /// The auxiliary layers asked for. Normals, depths and positions are means over the samples that hit something.
    std::vector<FilmLayer> layers(uint64_t samples) const;
    /// Ids of sample 0, row by row; empty without kAovIds.
    std::vector<PixelIds> ids() const { return ids_.download(); }
    uint64_t invalid_samples() const { return invalid_.download()[0]; }

private:
    uint32_t width_, height_, aovs_, channels_;
    Buffer<FixedSum> sums_;
    Buffer<PixelIds> ids_;
    Buffer<uint64_t> invalid_;
};

} // namespace pertev
