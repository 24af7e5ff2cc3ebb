#include "session/film_file/checkpoint.h"

#include <fmt/format.h>

#include "base/error.h"
#include "session/film_file/film_file.h"

namespace pertev {
namespace {

/// Returns how many bytes a film file may take: an exact sum of many samples has about five that differ.
uint64_t most_bytes(const Film& film) {
    uint64_t bytes = 0;
    for (const auto& target : film.targets()) {
        const std::size_t size = target->byte_count();
        bytes += target->stride() % sizeof(FixedSum) == 0 ? size / sizeof(FixedSum) * 5 : size;
    }
    return bytes;
}

} // namespace

Checkpoint::Checkpoint(std::string file, FilmHeader picture)
    : generations_(std::move(file)), picture_(std::move(picture)) {}

void Checkpoint::check_header(const std::string& file, const FilmHeader& header) const {
    const auto refuse = [&](const std::string& why) {
        Remark remark(FileLocation{file}, why + "; name another file, or delete it to start again");
        remark.setting = "checkpoint";
        throw RefusedGeneration(ErrorCode::BadInput, std::move(remark));
    };
    if (const auto different = film_difference(header, picture_)) {
        refuse("the checkpoint belongs to another picture: " + text_of(*different));
    }
    if (header.parts.size() > 1) refuse("the checkpoint is a merged film, whose rows have unequal samples or gaps");
    const FilmPart &of = header.part(), &wanted = picture_.part();
    if (of.is_empty()) return;
    if (of.first_row != wanted.first_row || of.end_row != wanted.end_row) {
        refuse(fmt::format("the checkpoint has the rows {} to {}, not {} to {} (`rows`)", of.first_row, of.end_row - 1,
                           wanted.first_row, wanted.end_row - 1));
    }
    if (of.samples.first != wanted.samples.first) {
        refuse(fmt::format("the checkpoint's samples begin with number {}, not {} (`part`, `samples`)",
                           of.samples.first, wanted.samples.first));
    }
    if (of.samples.end > wanted.samples.end) {
        refuse(fmt::format("the checkpoint has samples up to {}, more than the {} of this picture (`spp`)",
                           of.samples.end, wanted.samples.end));
    }
}

/// Takes the samples of one generation. Returns a notice of what was taken.
std::string Checkpoint::take(const std::string& file, FilmRender& film) const {
    FilmFileReader reader(file);
    const FilmHeader& header = reader.header();
    check_header(file, header);
    const FilmPart& part = header.part();
    if (part.is_empty()) return "";
    film.restore(
        part.samples, [&](Film& into) { reader.add_to(into); }, header.rays, header.render_seconds);
    return fmt::format("resumes from {} of {} samples in {}", part.samples.count(), picture_.part().samples.count(),
                       file);
}

void Checkpoint::restore(FilmRender& film, Sink& sink) {
    std::string notice; // follows a warning about the generation that was not taken
    const auto damage = generations_.take([&](const std::string& file) { notice = take(file, film); }, sink);
    if (damage) throw Error(damage->code(), damage->remark().and_then("; delete both files to start again"));
    if (!notice.empty()) sink.note(std::move(notice));
}

void Checkpoint::check_space(const Film& film) const { generations_.check_space(most_bytes(film)); }

void Checkpoint::write(FilmRender& film, PictureFacts facts) {
    FilmHeader header = picture_;
    header.facts = std::move(facts);
    header.rays = film.rays();
    const Film& sums = film.film();
    FilmPart& part = header.parts.front();
    if (sums.part().is_empty())
        part.samples.end = part.samples.first;
    else
        part = sums.part();
    header.render_seconds = film.stats().render_seconds;
    generations_.write(film_file_bytes(header, sums));
}

} // namespace pertev
