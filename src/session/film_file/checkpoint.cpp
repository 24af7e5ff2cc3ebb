#include "session/film_file/checkpoint.h"

#include <fmt/format.h>

#include "base/error.h"
#include "base/remove_leftovers.h"
#include "base/write_file_atomically.h"
#include "session/film_file/film_file.h"
#include "session/film_file/generations.h"

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
    : file_(std::move(file)), previous_(previous_generation(file_)), picture_(std::move(picture)) {}

void Checkpoint::check_header(const std::string& file, const FilmHeader& header) const {
    const auto refuse = [&](const std::string& why) {
        Remark remark(FileLocation{file}, why + "; name another file, or delete it to begin anew");
        remark.setting = "checkpoint";
        throw Error(ErrorCode::BadInput, std::move(remark));
    };
    if (const auto different = film_difference(header, picture_)) {
        refuse(fmt::format("the checkpoint belongs to another picture: {} is \"{}\" there, not \"{}\"", different->name,
                           different->before, different->after));
    }
    if (header.part.is_empty()) return;
    const SampleRange there = header.part.samples;
    if (header.part.first_row != picture_.part.first_row || header.part.end_row != picture_.part.end_row) {
        refuse(fmt::format("the checkpoint has the rows {} to {}, not {} to {} (`rows`)", header.part.first_row,
                           header.part.end_row - 1, picture_.part.first_row, picture_.part.end_row - 1));
    }
    if (there.first != picture_.part.samples.first) {
        refuse(fmt::format("the checkpoint's samples begin with number {}, not {} (`part`, `samples`)", there.first,
                           picture_.part.samples.first));
    }
    if (there.end > picture_.part.samples.end) {
        refuse(fmt::format("the checkpoint has samples up to {}, more than the {} of this picture (`spp`)", there.end,
                           picture_.part.samples.end));
    }
}

/// Takes the samples of one generation. Returns why it is damaged, or nothing.
std::optional<Error> Checkpoint::take(const std::string& file, FilmRender& film, Sink& sink) const {
    std::optional<FilmFileReader> reader;
    try {
        reader.emplace(file);
    } catch (const Error& error) {
        return error;
    }
    const FilmHeader& header = reader->header();
    check_header(file, header);
    if (header.part.is_empty()) return std::nullopt;
    try {
        film.restore(
            header.part.samples, [&](Film& into) { reader->add_to(into); }, header.rays, header.render_seconds);
    } catch (const Error& error) {
        if (error.code() != ErrorCode::BadInput) throw;
        return error;
    }
    sink.note(fmt::format("resumes from {} of {} samples in {}", header.part.samples.count(),
                          picture_.part.samples.count(), file));
    return std::nullopt;
}

void Checkpoint::restore(FilmRender& film, Sink& sink) {
    remove_leftovers(file_);
    if (!has_generation(file_)) {
        if (has_generation(previous_)) {
            sink.warn({FileLocation{previous_}, "the render does not resume from it, because its checkpoint is "
                                                "missing; rename it to the checkpoint to resume"});
        }
        return;
    }
    const std::optional<Error> damage = take(file_, film, sink);
    if (!damage) return;
    const Error refusal(damage->code(), damage->remark().and_then("; delete it to begin anew"));
    if (!has_generation(previous_)) throw refusal;
    is_damaged_ = true;
    sink.warn(damage->remark().and_then(fmt::format("; the previous generation, {}, is used", previous_)));
    if (take(previous_, film, sink)) throw refusal;
}

void Checkpoint::check_space(const Film& film) const { check_space_for_generations(file_, most_bytes(film)); }

void Checkpoint::write(FilmRender& film, PictureFacts facts) {
    FilmHeader header = picture_;
    header.facts = std::move(facts);
    header.rays = film.rays();
    const Film& sums = film.film();
    if (sums.part().is_empty())
        header.part.samples.end = header.part.samples.first;
    else
        header.part = sums.part();
    header.render_seconds = film.stats().render_seconds;
    const std::vector<std::byte> bytes = film_file_bytes(header, sums);
    if (is_damaged_)
        write_file_atomically(file_, bytes);
    else
        write_generation(file_, previous_, bytes);
    is_damaged_ = false;
}

} // namespace pertev
