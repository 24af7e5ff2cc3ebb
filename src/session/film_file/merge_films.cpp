#include "session/film_file/merge_films.h"

#include <algorithm>
#include <ranges>
#include <tuple>

#include <fmt/format.h>

#include "base/machine_memory.h"
#include "session/film_file/unite_id_names.h"
#include "session/post_steps.h"
#include "settings/settings_file.h"

namespace pertev {
namespace {

/// Order of films whose metadata a merged picture has: the first samples, if there are any, and of those the first row.
auto precedence(const FilmHeader& header) {
    const auto of_part = [](const FilmPart& part) {
        return std::tuple(part.is_empty(), part.samples.first, part.first_row);
    };
    return std::ranges::min(header.parts | std::views::transform(of_part));
}

bool overlap(const FilmPart& a, const FilmPart& b) {
    return !a.is_empty() && !b.is_empty() && a.first_row < b.end_row && b.first_row < a.end_row &&
           a.samples.first < b.samples.end && b.samples.first < a.samples.end;
}

/// Makes rows without samples black, because a denoiser has no features there.
void blacken_missing(const Film& film, Image& image) {
    film.row_samples().visit_pixels(film.width(), film.window().count(),
                                    [&](std::size_t first, std::size_t end, uint32_t samples) {
                                        if (samples > 0) return;
                                        std::fill(image.pixels.begin() + std::ptrdiff_t(first * image.channels),
                                                  image.pixels.begin() + std::ptrdiff_t(end * image.channels), 0.0f);
                                    });
}

} // namespace

FilmMerge::FilmMerge(std::span<const std::string> files, bool is_partial) {
    for (const std::string& file : files) {
        const FilmFileReader reader(file);
        take_header(file, reader.header());
        parts_.push_back({file, reader.header().parts, reader.header_hash()});
    }
    take_samples();
    if (!is_partial) refuse_gaps();
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
    const bool comes_first = precedence(header) < precedence(header_);
    const ExrMetadata& later = comes_first ? header_.facts.origin : header.facts.origin;
    ExrMetadata origin = comes_first ? header.facts.origin : header_.facts.origin;
    unite_id_names(later, origin);
    if (comes_first) header_ = header;
    header_.facts.origin = std::move(origin);
    header_.rays = rays, header_.render_seconds = seconds, header_.spp = spp;
}

/// Takes the samples of all parts, which must not overlap.
void FilmMerge::take_samples() {
    samples_ = RowSamples(header_.height);
    for (std::size_t i = 0; i < parts_.size(); ++i)
        for (const FilmPart& part : parts_[i].of)
            if (!samples_.add(part)) refuse_overlap(i, part);
    header_.parts = samples_.parts();
    if (header_.parts.empty())
        throw Error(ErrorCode::BadInput, FileLocation{parts_.front().file}, "none of the files contains a sample");
}

/// Names the file before number `number` that has samples of its `part`.
void FilmMerge::refuse_overlap(std::size_t number, const FilmPart& part) const {
    for (const Part& before : std::span(parts_).first(number)) {
        for (const FilmPart& other : before.of) {
            if (!overlap(part, other)) continue;
            throw Error(ErrorCode::BadInput, FileLocation{parts_[number].file},
                        fmt::format("the samples {} to {} of rows {} to {} are also in {}",
                                    std::max(part.samples.first, other.samples.first),
                                    std::min(part.samples.end, other.samples.end) - 1,
                                    std::max(part.first_row, other.first_row),
                                    std::min(part.end_row, other.end_row) - 1, before.file));
        }
    }
    PERTEV_CHECK(false); // a part overlaps none of its own file
}

void FilmMerge::refuse_gaps() const {
    for (const RowSamples::Band& band : samples_.bands()) {
        const SampleRange missing = band.first_missing(header_.spp);
        if (missing.count() == 0) continue;
        throw Error(
            ErrorCode::BadInput, FileLocation{parts_.front().file},
            fmt::format(
                "samples {} to {} of rows {} to {} are in none of the files; set `partial` to merge without them",
                missing.first, missing.end - 1, band.first_row, band.end_row - 1));
    }
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
    film.set_row_samples(samples_);
    return film;
}

RenderResult result_of(const FilmHeader& header, Film& film, Queue& queue) {
    RenderResult result;
    result.samples = film.row_samples().most();
    result.rays = header.rays;
    result.invalid_samples = film.invalid_samples();
    result.render_seconds = header.render_seconds;
    result.picture = film.picture(header.facts.transparent);
    result.layers = film.layers();
    result.ids = film.ids();
    if (!header.is_denoised()) return result;
    RenderSettings settings;
    settings.width = header.width, settings.height = header.height, settings.denoise = header.denoise;
    DenoiserTarget* const gathered = denoiser_target(film);
    PERTEV_CHECK(gathered != nullptr);
    auto [image, denoiser] = denoise(queue, settings, result.picture, gathered->take());
    blacken_missing(film, image);
    result.denoised = std::move(image), result.denoiser = std::move(denoiser);
    return result;
}

} // namespace pertev
