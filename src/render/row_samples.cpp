#include "render/row_samples.h"

#include <iterator>

#include "base/error.h"

namespace pertev {
namespace {

/// Returns where a range belongs among the others of its row: at the first one that ends after its begin.
auto position_of(const std::vector<SampleRange>& ranges, const SampleRange& range) {
    return std::ranges::upper_bound(ranges, range.first, {}, &SampleRange::end);
}

bool overlaps(const std::vector<SampleRange>& ranges, const SampleRange& range) {
    const auto next = position_of(ranges, range);
    return next != ranges.end() && next->first < range.end;
}

/// Inserts a range that overlaps none, and joins it with those that it touches.
void insert(const SampleRange& range, std::vector<SampleRange>& ranges) {
    auto at = ranges.insert(position_of(ranges, range), range);
    if (const auto next = std::next(at); next != ranges.end() && next->first == at->end) {
        at->end = next->end;
        at = std::prev(ranges.erase(next));
    }
    if (at != ranges.begin() && std::prev(at)->end == at->first) {
        std::prev(at)->end = at->end;
        ranges.erase(at);
    }
}

} // namespace

uint32_t RowSamples::Band::count() const {
    uint32_t sum = 0;
    for (const SampleRange& range : ranges) sum += range.count();
    return sum;
}

SampleRange RowSamples::Band::first_missing(uint32_t end) const {
    uint32_t at = 0;
    for (const SampleRange& range : ranges) {
        if (range.first > at) return {at, range.first};
        at = range.end;
    }
    return {at, std::max(at, end)};
}

/// Makes a row the first one of a band, and returns its number, or the number of bands if the row is the end of
/// the film.
std::size_t RowSamples::split_at(uint32_t row) {
    const auto at = std::ranges::lower_bound(bands_, row, {}, &Band::first_row);
    const auto number = static_cast<std::size_t>(at - bands_.begin());
    if ((at != bands_.end() && at->first_row == row) || bands_.back().end_row == row) return number;
    Band& before = *std::prev(at);
    Band after = {row, before.end_row, before.ranges};
    before.end_row = row;
    bands_.insert(at, std::move(after));
    return number;
}

bool RowSamples::add(const FilmPart& part) {
    if (part.is_empty()) return true;
    PERTEV_CHECK(part.first_row < part.end_row && part.end_row <= bands_.back().end_row);
    auto first = std::ranges::upper_bound(bands_, part.first_row, {}, &Band::end_row);
    for (auto band = first; band != bands_.end() && band->first_row < part.end_row; ++band)
        if (overlaps(band->ranges, part.samples)) return false;
    const std::size_t begin = split_at(part.first_row), end = split_at(part.end_row);
    for (std::size_t k = begin; k < end; ++k) insert(part.samples, bands_[k].ranges);
    for (std::size_t k = std::min(end, bands_.size() - 1), least = std::max<std::size_t>(begin, 1); k >= least; --k) {
        if (bands_[k - 1].ranges != bands_[k].ranges) continue;
        bands_[k - 1].end_row = bands_[k].end_row;
        bands_.erase(bands_.begin() + static_cast<std::ptrdiff_t>(k));
    }
    return true;
}

std::vector<FilmPart> RowSamples::parts() const {
    std::vector<FilmPart> parts;
    for (const Band& band : bands_)
        for (const SampleRange& range : band.ranges) parts.push_back({band.first_row, band.end_row, range});
    return parts;
}

} // namespace pertev
