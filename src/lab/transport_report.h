#pragma once

// What the laboratory measured of light transport: plain data that becomes tables, plots, CSV, JSON. Each integrator
// renders one picture several times with different seeds (repetitions), and is compared with one reference after 1, 2,
// 4, ... samples of each pixel. Errors are those of `pertev compare`: relMSE is the mean of (x - r)^2 / (r^2 + 0.01)
// over pixels and channels, FLIP is HDR-FLIP. What follows from the measured (means, bands, equal time, efficiency) is
// computed here.

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "lab/measurement.h"

namespace pertev {

/// One picture of a repetition, with all samples that came before in it.
struct TransportFigures {
    uint32_t samples = 0; // of each pixel
    double seconds = 0;   // of rendering alone, of all these samples; of a solution, that of solving too
    double rel_mse = 0, flip = 0;
    uint64_t patches = 0;    // of the solution that is shown; 0: nothing was solved
    double made_seconds = 0; // of `seconds`, that what all samples need took: before the first, and once
};

/// Samples rise; of solutions patches do. Cut short by an interrupt, it ends early.
using Repetition = std::vector<TransportFigures>;

/// One integrator.
struct TransportRow {
    std::string name;
    std::string light;      // which light it finds, in Heckbert's letters where it is not all
    bool finds_all = false; // without bias: its error is noise alone
    std::string refused;    // why it has no figures; empty: it has, or was not reached
    /// Its light is solved and not sampled: each picture is of a solution of its own, and comes to nothing more in
    /// time.
    bool is_solved = false;
    std::size_t bytes = 0;      // the most of the device's memory that it was seen to hold, the scene's included
    std::size_t host_bytes = 0; // of the host's memory: the most that solving took, or that records may take
    uint64_t invalid_samples = 0;
    std::vector<Repetition> repetitions; // none is empty
};

struct TransportReference {
    std::string file; // as it was named; empty: made by
    std::string integrator;
    uint32_t samples = 0; // of each pixel
    double seconds = 0;   // of rendering
    /// What its own noise adds to every relMSE, estimated from its two halves; none of a file.
    std::optional<double> rel_mse;
    std::optional<double> flip; // of one half against the other
    std::string lacks;          // light that it cannot have; empty: nothing is known
};

/// One scene.
struct TransportScene {
    std::string name, shows; // what it is there for; empty: it is the caller's
    std::string camera;      // describe_camera in the words of the front end
    uint64_t triangles = 0;
    TransportReference reference;
    std::vector<TransportRow> rows;
    std::vector<std::string> notes;
    std::vector<ResultPicture> pictures; // the reference, then the last of each integrator's first repetition
    bool interrupted = false;
};

struct TransportReport {
    std::string device, commit;
    uint32_t threads = 0; // of the CPU
    uint32_t width = 0, height = 0, max_depth = 0, repetitions = 0, seed = 0;
    double seconds = 0; // of rendering, that each integrator had in each scene
    std::vector<TransportScene> scenes;
    bool interrupted = false;
};

/// A mean over repetitions. `half_width` is that of its 95 % confidence interval by Student's t, as if the values were
/// normally distributed; none of fewer than two values.
struct Estimate {
    double mean = 0;
    std::optional<double> half_width;
};

/// Of at least one value.
Estimate estimate_of(std::span<const double> values);
/// The 97.5 % quantile of Student's t distribution with so many degrees of freedom, at least 1.
double student_t(uint32_t degrees);

/// An integrator at one number of samples, or at one time.
struct TransportPoint {
    double samples = 0;
    Estimate seconds, rel_mse, flip;
    uint32_t repetitions = 0; // that have it
    double patches = 0;       // mean of those shown
};

/// After each number of samples that all its repetitions have begun with. Empty where there are no figures.
std::vector<TransportPoint> points_of(const TransportRow& row);

/// Each repetition's curve is interpolated, straight in the logarithms of value and of the time that samples took (a
/// value of 0 is interpolated as it is), and the mean is over these. None where `seconds` lies before a repetition's
/// first figures or behind its last, or there are none. Of solutions it is the last that is there by then.
std::optional<TransportPoint> at_time(const TransportRow& row, double seconds);
/// None where there is no such number in all repetitions, and of solutions, which samples make no better.
std::optional<TransportPoint> at_samples(const TransportRow& row, uint32_t samples);

/// The longest time that all repetitions of all integrators with figures have come to, and the largest number of
/// samples that all of them have a picture of; 0: there is none. Solutions do not count, but for the time where there
/// is nothing else.
double equal_seconds(const TransportScene& scene);
uint32_t equal_samples(const TransportScene& scene);

/// 1 / (relMSE seconds), of means; none where either is 0. That of light without noise tells nothing of work done.
std::optional<double> efficiency(const TransportPoint& point);

/// "path, 1024 samples, 12.3 s; its noise: relMSE 1e-05"
std::string describe_reference(const TransportReference& reference);

/// Whether anything was measured.
bool has_findings(const TransportScene& scene);
bool has_findings(const TransportReport& report);

} // namespace pertev
