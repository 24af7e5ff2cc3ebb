#include "session/pictures/merge_picture.h"

#include <algorithm>

#include <fmt/format.h>

#include "base/error.h"
#include "session/writing/check_outputs.h"
#include "settings/value_names.h"

namespace pertev {
namespace {

void refuse_film_with_gaps(std::span<const std::string> outputs) {
    const auto film = std::ranges::find_if(outputs, is_film_name);
    if (film == outputs.end()) return;
    throw Error(ErrorCode::BadInput, "output", *film, "a film file holds no samples with gaps between them");
}

void check_denoiser(const std::string& wanted, const FilmHeader& header, std::span<const std::string> files) {
    const std::string_view there = name_of(header.denoise);
    if (wanted.empty() || wanted == there) return;
    Remark remark(FileLocation{files.front()},
                  header.denoise == Denoise::None
                      ? "the film lacks what a denoiser gathers; render its parts with `denoise` too, by `rows`"
                      : fmt::format("the film was rendered with `denoise={}`", there));
    remark.setting = "denoise", remark.value = wanted;
    throw Error(ErrorCode::BadInput, std::move(remark));
}

} // namespace

MergedPicture merge_picture(std::span<const std::string> files, const MergeOptions& options,
                            std::span<const std::string> outputs, Sink& sink) {
    check_outputs({}, outputs, sink);
    const FilmMerge parts(files, options.is_partial);
    check_denoiser(options.denoise, parts.header(), files);
    if (parts.has_gaps()) refuse_film_with_gaps(outputs);
    Queue queue = Queue::make_cpu();
    MergedPicture picture;
    FilmHeader header = parts.header();
    show_merged(options.display, files.front(), header.facts);
    picture.facts = header.facts;
    if (!writes_tone_mapped(outputs)) picture.facts.shown.clear(); // which only film files have
    Film film = parts.film(queue, sink);
    picture.films = write_film_files(outputs, header, film);
    picture.result = result_of(header, film, queue);
    return picture; // without the film, because writing takes memory too
}

} // namespace pertev
