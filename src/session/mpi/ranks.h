#pragma once

// The processes that mpirun starts together to render one picture. Each renders its part into a film file of its own
// (session/film_file/checkpoint.h) and the first one sums the films. Of a sequence each writes its part of the frames.
// A build without MPI (PERTEV_MPI) has the same functions, and refuses to be one of several ranks.
//
// Source: MPI: A Message-Passing Interface Standard 3.1, section 5.9.5 (operations of the user).

#include <cstdint>
#include <memory>
#include <string>

#include "session/film_render.h"
#include "settings/picture_options.h"

namespace pertev {

/// Returns the GPU of a process, of which `number` others of its machine come before it; empty if there is no choice.
std::string gpu_of_rank(uint32_t number, uint32_t gpus);

class Ranks {
public:
    /// Joins the other processes if mpirun started several; otherwise returns null. Throws Error(BadInput) if this
    /// build cannot.
    static std::unique_ptr<Ranks> join();
    /// Leaves, together with the others, unless an exception ends this process; mpirun then ends the others.
    ~Ranks();
    Ranks(const Ranks&) = delete;
    Ranks& operator=(const Ranks&) = delete;

    uint32_t rank() const { return rank_; } // from 0
    uint32_t count() const { return count_; }

    /// Sets the part of this rank, of a single picture its checkpoint, a film file beside `output`, and, if several
    /// GPUs are there and no device was given, a GPU for each rank of this machine. Throws Error(BadInput) if a
    /// checkpoint was given.
    void divide(const std::string& output, PictureOptions& options) const;
    /// Returns whether all ranks call it with true. Each rank calls it, and waits for the others.
    bool all(bool here) const;
    /// Adds the films and the statistics of the other ranks to those of the first one, which then are those of `spp`
    /// samples of each pixel, denoised if that is set. Each rank calls it. Throws Error(OutOfMemory, DeviceFault).
    void sum(uint32_t spp, FilmRender& film, RenderResult& result) const;

private:
    Ranks(uint32_t rank, uint32_t count) : rank_(rank), count_(count) {}

    void sum_targets(Film& film) const;
    void sum_denoised(uint32_t spp, FilmRender& film, const RayCounts& rays, double seconds) const;

    uint32_t rank_, count_;
};

} // namespace pertev
