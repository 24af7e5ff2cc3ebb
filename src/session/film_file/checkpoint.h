#pragma once

// The checkpoint of a picture: a film file (film_file.h) with the samples so far, and the generation before it.

#include <string>

#include "base/sink.h"
#include "session/film_file/film_header.h"
#include "session/film_file/generations.h"
#include "session/film_render.h"

namespace pertev {

class Checkpoint {
public:
    /// Makes an object without reading anything. `picture` is the header of the finished film.
    Checkpoint(std::string file, FilmHeader picture);

    /// Takes the samples of the file, if it is there, into `film`, and notes how many. If the file is damaged, it warns
    /// and takes those of the generation before. Throws Error(BadInput) if the file is of another picture, naming the
    /// first difference, or if no generation is whole.
    void restore(FilmRender& film, Sink& sink);
    /// Throws Error(FileWrite) if two generations of `film`, and the next while it is written, may not fit on the disk.
    void check_space(const Film& film) const;
    /// Replaces the file by all samples of the film; the file so far becomes the generation before. `facts` are those
    /// of the picture. Throws Error(FileWrite) and leaves the old file unchanged.
    void write(FilmRender& film, PictureFacts facts);

    const std::string& file() const { return generations_.file(); }

private:
    void check_header(const std::string& file, const FilmHeader& header) const;
    std::string take(const std::string& file, FilmRender& film) const;

    Generations generations_;
    FilmHeader picture_;
};

} // namespace pertev
