#include "session/film_file/merge_picture.h"

#include <algorithm>

#include "base/error.h"
#include "session/writing/check_outputs.h"

namespace pertev {
namespace {

void refuse_film_with_gaps(std::span<const std::string> outputs) {
    const auto film = std::ranges::find_if(outputs, is_film_name);
    if (film == outputs.end()) return;
    throw Error(ErrorCode::BadInput, "output", *film, "a film file holds no samples with gaps between them");
}

} // namespace

MergedPicture merge_picture(std::span<const std::string> files, bool is_partial, std::span<const std::string> outputs,
                            Sink& sink) {
    check_outputs({}, outputs, sink);
    const FilmMerge parts(files, is_partial);
    if (parts.has_gaps()) refuse_film_with_gaps(outputs);
    Queue queue = Queue::make_cpu();
    MergedPicture picture;
    picture.facts = parts.header().facts;
    if (!writes_tone_mapped(outputs)) picture.facts.shown.clear(); // which only film files have
    Film film = parts.film(queue, sink);
    picture.films = write_film_files(outputs, parts.header(), film);
    picture.result = result_of(parts.header(), film, queue);
    return picture; // without the film, because writing takes memory too
}

} // namespace pertev
