#include "session/pictures/merge_picture.h"

#include <algorithm>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/error.h"
#include "session/writing/check_outputs.h"
#include "settings/value_names.h"

namespace pertev {
namespace {

/// Rows [first, end) with equal numbers of samples.
struct CountedRows {
    uint32_t first, end, samples;
};

std::vector<CountedRows> counted_rows(const RowSamples& samples) {
    std::vector<CountedRows> all;
    for (const RowSamples::Band& band : samples.bands()) {
        if (!all.empty() && all.back().samples == band.count())
            all.back().end = band.end_row; // other samples of the same number
        else
            all.push_back({band.first_row, band.end_row, band.count()});
    }
    return all;
}

/// Returns a warning about rows with unequal numbers of samples.
std::string warning_of(std::span<const CountedRows> rows) {
    constexpr std::size_t kMostNamed = 8;
    std::string text = "the rows have unequal numbers of samples: ";
    for (std::size_t i = 0; i < std::min(rows.size(), kMostNamed); ++i) {
        const auto& [first, end, samples] = rows[i];
        text += i == 0 ? "" : ", ";
        text += end - first == 1 ? fmt::format("row {} has {}", first, samples)
                                 : fmt::format("rows {} to {} have {}", first, end - 1, samples);
    }
    if (rows.size() > kMostNamed)
        text += fmt::format(", and so on for {} more ranges of rows", rows.size() - kMostNamed);
    return text;
}

/// Adds the samples of each range of rows to the metadata.
void record_rows(std::span<const CountedRows> rows, uint32_t least, ExrMetadata& origin) {
    std::vector<std::string> counts;
    for (const auto& [first, end, samples] : rows) counts.push_back(fmt::format(R"("{}:{}":{})", first, end, samples));
    origin.emplace_back("pertev.least_spp", static_cast<int32_t>(least));
    origin.emplace_back("pertev.row_samples", fmt::format("{{{}}}", fmt::join(counts, ",")));
}

void check_denoiser(const PictureOptions& options, const FilmHeader& header, std::span<const std::string> files) {
    if (!options.is_given("denoise") || options.render.denoise == header.denoise) return;
    const std::string_view there = name_of(header.denoise);
    Remark remark(FileLocation{files.front()},
                  header.is_denoised() ? fmt::format("the film was rendered with `denoise={}`", there)
                                       : "the film lacks what a denoiser gathers; render its parts with `denoise` too");
    remark.setting = "denoise", remark.value = name_of(options.render.denoise);
    throw Error(ErrorCode::BadInput, std::move(remark));
}

} // namespace

MergedPicture merge_picture(std::span<const std::string> files, bool is_partial, const PictureOptions& options,
                            std::span<const std::string> outputs, Sink& sink) {
    if (!outputs.empty()) check_outputs(options, outputs, sink); // else the caller shows the picture
    const FilmMerge parts(files, is_partial);
    check_denoiser(options, parts.header(), files);
    Queue queue = Queue::make_cpu();
    MergedPicture picture;
    FilmHeader header = parts.header();
    show_merged(options, files.front(), header.facts);
    picture.facts = header.facts;
    picture.least_samples = parts.samples().least();
    if (const std::vector<CountedRows> rows = counted_rows(parts.samples()); rows.size() > 1) {
        sink.warn(warning_of(rows));
        record_rows(rows, picture.least_samples, picture.facts.origin);
    } else if (picture.least_samples < header.spp) {
        sink.warn(fmt::format("the picture has {} of {} samples", picture.least_samples, header.spp));
    }
    if (!writes_tone_mapped(outputs)) picture.facts.shown.clear(); // only film files have them
    Film film = parts.film(queue, sink);
    picture.films = write_film_files(outputs, header, film);
    picture.result = result_of(header, film, queue);
    return picture; // without the film, because writing takes memory too
}

} // namespace pertev
