#include "session/film_file/merge_films.h"

#include <algorithm>
#include <set>
#include <tuple>

#include <fmt/format.h>

#include "base/machine_memory.h"
#include "session/film_file/unite_id_names.h"
#include "session/post_steps.h"
#include "settings/settings_file.h"

namespace pertev {
namespace {

/// Order of parts whose metadata a merged picture has: the first samples, if there are any.
auto precedence(const FilmPart& part) { return std::tuple(part.is_empty(), part.samples.first, part.first_row); }

bool overlap(const FilmPart& a, const FilmPart& b) {
    return !a.is_empty() && !b.is_empty() && a.first_row < b.end_row && b.first_row < a.end_row &&
           a.samples.first < b.samples.end && b.samples.first < a.samples.end;
}

/// Samples of the rows between two neighbouring borders.
struct Band {
    uint32_t first_row, end_row;
    std::vector<SampleRange> ranges = {}; // disjoint and in order

    uint32_t count() const {
        uint32_t sum = 0;
        for (const SampleRange& range : ranges) sum += range.count();
        return sum;
    }
    /// Returns the first samples of [0, end) that are missing; empty if none is.
    SampleRange first_missing(uint32_t end) const {
        uint32_t at = 0;
        for (const SampleRange& range : ranges) {
            if (range.first > at) return {at, range.first};
            at = range.end;
        }
        return {at, std::max(at, end)};
    }
};

std::vector<Band> bands_of(const std::vector<FilmPart>& parts, uint32_t height) {
    std::set<uint32_t> borders = {0, height};
    for (const FilmPart& part : parts) borders.insert({part.first_row, part.end_row});
    std::vector<Band> bands;
    for (auto border = borders.begin(); std::next(border) != borders.end(); ++border) {
        Band& band = bands.emplace_back(Band{*border, *std::next(border)});
        for (const FilmPart& part : parts) {
            if (!part.is_empty() && part.first_row <= band.first_row && band.end_row <= part.end_row)
                band.ranges.push_back(part.samples);
        }
        std::ranges::sort(band.ranges, {}, &SampleRange::first);
    }
    return bands;
}

} // namespace

FilmMerge::FilmMerge(std::span<const std::string> files, bool is_partial) {
    for (const std::string& file : files) {
        const FilmFileReader reader(file);
        take_header(file, reader.header());
        parts_.push_back({file, reader.header().part, reader.header_hash()});
    }
    refuse_overlaps();
    check_rows(is_partial);
    for (auto& [name, value] : header_.facts.origin) {
        auto* const text = std::get_if<std::string>(&value);
        if (text != nullptr && name == "pertev.settings") *text = with_samples(*text, fmt::format("{}", header_.spp));
    }
}

void FilmMerge::take_header(const std::string& file, const FilmHeader& header) {
    if (parts_.empty()) {
        header_ = header;
        return;
    }
    if (const auto different = film_difference(header_, header)) {
        throw Error(
            ErrorCode::BadInput, FileLocation{file},
            fmt::format("this is not a part of the same picture as {}: {}", parts_.front().file, text_of(*different)));
    }
    const RayCounts rays = header_.rays + header.rays;
    const double seconds = header_.render_seconds + header.render_seconds;
    const uint32_t spp = std::max(header_.spp, header.spp);
    const bool comes_first = precedence(header.part) < precedence(header_.part);
    const ExrMetadata& later = comes_first ? header_.facts.origin : header.facts.origin;
    ExrMetadata origin = comes_first ? header.facts.origin : header_.facts.origin;
    unite_id_names(later, origin);
    if (comes_first) header_ = header;
    header_.facts.origin = std::move(origin);
    header_.rays = rays, header_.render_seconds = seconds, header_.spp = spp;
}

void FilmMerge::refuse_overlaps() const {
    for (std::size_t i = 0; i < parts_.size(); ++i) {
        for (std::size_t k = 0; k < i; ++k) {
            if (!overlap(parts_[i].of, parts_[k].of)) continue;
            const FilmPart &a = parts_[i].of, &b = parts_[k].of;
            throw Error(ErrorCode::BadInput, FileLocation{parts_[i].file},
                        fmt::format("the samples {} to {} of rows {} to {} are also in {}",
                                    std::max(a.samples.first, b.samples.first),
                                    std::min(a.samples.end, b.samples.end) - 1, std::max(a.first_row, b.first_row),
                                    std::min(a.end_row, b.end_row) - 1, parts_[k].file));
        }
    }
}

void FilmMerge::check_rows(bool is_partial) {
    std::vector<FilmPart> parts;
    for (const Part& part : parts_) parts.push_back(part.of);
    const std::vector<Band> bands = bands_of(parts, header_.height);
    const FileLocation place = {parts_.front().file};
    if (std::ranges::all_of(parts, &FilmPart::is_empty))
        throw Error(ErrorCode::BadInput, place, "none of the files contains a sample");
    uint32_t count = 0;
    for (const Band& band : bands) count = std::max(count, band.count());
    const bool are_even = std::ranges::all_of(bands, [&](const Band& band) { return band.count() == count; });
    uint32_t first = UINT32_MAX;
    for (const Band& band : bands) {
        const SampleRange missing = band.first_missing(header_.spp);
        if (missing.count() > 0 && !is_partial) {
            throw Error(ErrorCode::BadInput, place,
                        fmt::format("samples {} to {} of rows {} to {} are in none of the files{}", missing.first,
                                    missing.end - 1, band.first_row, band.end_row - 1,
                                    are_even ? "; set `partial` to merge without them"
                                             : ", and no picture can be without them, because other rows have more"));
        }
        if (band.count() != count) {
            throw Error(ErrorCode::BadInput, place,
                        fmt::format("rows {} to {} have {} samples, and others {}", band.first_row, band.end_row - 1,
                                    band.count(), count));
        }
        const uint32_t begin =
            band.ranges.front().first; // there is one: all bands have as many samples, and some have any
        if (first == UINT32_MAX) first = begin;
        has_gaps_ = has_gaps_ || begin != first || band.ranges.back().end - begin != count;
    }
    const uint32_t begin = has_gaps_ ? 0 : first;
    header_.part = {0, header_.height, {begin, begin + count}};
}

Film FilmMerge::film(Queue& queue, Sink& sink) const {
    Queue counting = Queue::make_dry_run(false);
    const Film counted = header_.make_film(counting);
    const std::size_t bytes = counting.allocated_bytes();
    if (bytes > machine_memory_bytes()) {
        throw Error(ErrorCode::OutOfMemory, FileLocation{parts_.front().file},
                    fmt::format("the film takes {:.1f} MiB; this machine has {:.1f} MiB", mebibytes(bytes),
                                mebibytes(machine_memory_bytes())));
    }
    Film film = header_.make_film(queue);
    std::size_t done = 0;
    for (const Part& part : parts_) {
        sink.check();
        FilmFileReader reader(part.file);
        if (reader.header_hash() != part.header)
            throw Error(ErrorCode::BadInput, FileLocation{part.file}, "the file has changed since its header was read");
        reader.add_to(film);
        sink.progress({.doing = "merging", .share = static_cast<double>(++done) / static_cast<double>(parts_.size())});
    }
    film.set_part(header_.part);
    return film;
}

RenderResult result_of(const FilmHeader& header, Film& film, Queue& queue) {
    RenderResult result;
    result.samples = film.part().samples.count();
    result.rays = header.rays;
    result.invalid_samples = film.invalid_samples();
    result.render_seconds = header.render_seconds;
    result.picture = film.picture(header.facts.transparent);
    result.layers = film.layers();
    result.ids = film.ids();
    if (header.denoise == Denoise::None) return result;
    RenderSettings settings;
    settings.width = header.width, settings.height = header.height, settings.denoise = header.denoise;
    DenoiserTarget* const gathered = denoiser_target(film);
    PERTEV_CHECK(gathered != nullptr);
    auto [image, denoiser] = denoise(queue, settings, result.picture, gathered->take());
    result.denoised = std::move(image), result.denoiser = std::move(denoiser);
    return result;
}

} // namespace pertev
