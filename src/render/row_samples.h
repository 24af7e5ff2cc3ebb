#pragma once

// Which samples the rows of a film have. Rows of one render have the same samples; those of merged parts may not.

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace pertev {

/// Samples [first, end) of each pixel.
struct SampleRange {
    uint32_t first = 0, end = 0;
    uint32_t count() const { return end - first; }
    bool operator==(const SampleRange&) const = default;
};

/// A part of a picture: a range of samples of each pixel of the rows [first_row, end_row).
struct FilmPart {
    uint32_t first_row = 0, end_row = 0;
    SampleRange samples;
    bool is_empty() const { return first_row == end_row || samples.count() == 0; }
    bool operator==(const FilmPart&) const = default;
};

/// Bands of rows with equal samples. They depend on the set of samples alone, not on the parts that it was made of.
class RowSamples {
public:
    struct Band {
        uint32_t first_row, end_row;
        std::vector<SampleRange> ranges = {}; // in order, with gaps between them; none: no samples

        uint32_t count() const;
        /// Returns the first samples of [0, end) that are missing; empty if none is.
        SampleRange first_missing(uint32_t end) const;
    };

    /// Makes `height` rows, at least one, without samples.
    explicit RowSamples(uint32_t height) : bands_{{0, height}} {}

    /// Adds the samples of a part. Returns false, and adds nothing, if any of them is there.
    bool add(const FilmPart& part);

    /// All rows, in order.
    std::span<const Band> bands() const { return bands_; }
    /// Returns the samples as disjoint parts, by rows and then by samples; none of them is empty.
    std::vector<FilmPart> parts() const;
    /// The number of samples of the rows with the fewest and of those with the most.
    uint32_t least() const { return std::ranges::min_element(bands_, {}, &Band::count)->count(); }
    uint32_t most() const { return std::ranges::max_element(bands_, {}, &Band::count)->count(); }

    /// Calls visit(first, end, samples) for the pixels [first, end) of each band of a film of this width, of the first
    /// `pixels` pixels.
    template <class Visit>
    void visit_pixels(uint32_t width, std::size_t pixels, const Visit& visit) const {
        for (const Band& band : bands_) {
            const std::size_t first = std::size_t(band.first_row) * width;
            if (first >= pixels) return;
            visit(first, std::min(std::size_t(band.end_row) * width, pixels), band.count());
        }
    }

private:
    std::size_t split_at(uint32_t row);

    std::vector<Band> bands_;
};

} // namespace pertev
