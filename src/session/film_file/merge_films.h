#pragma once

// Merges film files of one picture, in any order, into the film that one run would have made. Memory is that of one
// film, however many files there are.

#include <span>
#include <string>
#include <vector>

#include "base/sink.h"
#include "session/film_file/film_file.h"

namespace pertev {

class FilmMerge {
public:
    /// Reads the headers. Throws Error(BadInput) for parts of different pictures, naming the first difference, for
    /// parts that overlap or have no sample, and, unless `is_partial`, if samples are missing. Throws as
    /// FilmFileReader.
    FilmMerge(std::span<const std::string> files, bool is_partial);

    /// Returns the header of the merged film. Its metadata are those of the part with the first samples.
    const FilmHeader& header() const { return header_; }
    /// Returns which samples the files have.
    const RowSamples& samples() const { return samples_; }
    /// Reads and adds all films. Throws as FilmFileReader, and Error(OutOfMemory, Interrupted).
    Film film(Queue& queue, Sink& sink) const;

private:
    struct Part {
        std::string file;
        std::vector<FilmPart> of;
        Hash128 header;
    };
    void take_header(const std::string& file, const FilmHeader& header);
    void take_samples();
    void refuse_overlap(std::size_t number, const FilmPart& part) const;
    void refuse_gaps() const;

    std::vector<Part> parts_;
    FilmHeader header_;
    RowSamples samples_{1};
};

/// Returns the result of a merged film, as one run has it, denoised on `queue` if its parts were rendered for that. Its
/// number of samples is that of the rows with the most; rows without samples are black. Throws Error(BadInput) if the
/// film lacks what the denoiser needs, and Error(OutOfMemory, DeviceFault).
RenderResult result_of(const FilmHeader& header, Film& film, Queue& queue);

} // namespace pertev
