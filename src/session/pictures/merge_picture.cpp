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

void check_denoiser(const PictureOptions& options, const FilmHeader& header, std::span<const std::string> files) {
    if (!options.is_given("denoise") || options.render.denoise == header.denoise) return;
    const std::string_view there = name_of(header.denoise);
    Remark remark(FileLocation{files.front()},
                  header.denoise == Denoise::None
                      ? "the film lacks what a denoiser gathers; render its parts with `denoise` too"
                      : fmt::format("the film was rendered with `denoise={}`", there));
    remark.setting = "denoise", remark.value = name_of(options.render.denoise);
    throw Error(ErrorCode::BadInput, std::move(remark));
}

} // namespace

MergedPicture merge_picture(std::span<const std::string> files, bool is_partial, const PictureOptions& options,
                            std::span<const std::string> outputs, Sink& sink) {
    if (!outputs.empty()) check_outputs(options, outputs, sink); // else the caller shows the picture
    const FilmMerge parts(files, is_partial);
    check_denoiser(options, parts.header(), files);
    if (parts.has_gaps()) refuse_film_with_gaps(outputs);
    Queue queue = Queue::make_cpu();
    MergedPicture picture;
    FilmHeader header = parts.header();
    show_merged(options, files.front(), header.facts);
    picture.facts = header.facts;
    if (!writes_tone_mapped(outputs)) picture.facts.shown.clear(); // which only film files have
    Film film = parts.film(queue, sink);
    picture.films = write_film_files(outputs, header, film);
    picture.result = result_of(header, film, queue);
    return picture; // without the film, because writing takes memory too
}

} // namespace pertev
