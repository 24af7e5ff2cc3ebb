#pragma once

// Results of the light transport laboratory as plain data, which becomes tables, plots, CSV and JSON. Each integrator
// renders one view several times with different seeds (repetitions) and is compared with one reference after 1, 2, 4,
// ... samples per pixel. `pertev compare` defines the errors: relMSE is the mean of (x - r)^2 / (r^2 + 0.01) over
// pixels and channels, FLIP is HDR-FLIP. Derived figures (means, confidence intervals, equal time, efficiency) are
// computed here.

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "lab/measurement.h"

namespace pertev {

/// A picture of a repetition, which contains all samples so far.
struct TransportFigures {
    uint32_t samples = 0; // per pixel
    double seconds = 0;   // rendering time of all these samples; a solution's includes solving
    double rel_mse = 0, flip = 0;
    uint64_t patches = 0;    // patches in the displayed solution; 0 if nothing was solved
    double made_seconds = 0; // the part of `seconds` spent once, on preparation before the first sample
};

/// The pictures of a repetition, with increasing sample counts; for solutions, patch counts. It is shorter if it was
/// interrupted.
using Repetition = std::vector<TransportFigures>;

/// All results of one integrator in a scene.
struct TransportRow {
    std::string name;
    std::string light;      // the light that it finds, in Heckbert's notation unless it is all light
    bool finds_all = false; // it is unbiased: its error consists only of noise
    std::string refused;    // reason why it has no figures; empty if it has some or was not reached
    /// True if its light is solved and not sampled: each picture shows its own solution, which more samples do not
    /// improve.
    bool is_solved = false;
    std::size_t bytes = 0;      // largest use of device memory that was observed, including the scene
    std::size_t host_bytes = 0; // largest use of host memory: measured for solvers, allocated for records
    uint64_t invalid_samples = 0;
    std::vector<Repetition> repetitions; // never contains an empty repetition
};

struct TransportReference {
    std::string file; // name of a given file; empty if `integrator` rendered it
    std::string integrator;
    uint32_t samples = 0; // per pixel
    double seconds = 0;   // rendering time
    /// The relMSE that the reference's own noise adds to every result, estimated from its two halves; absent for a
    /// file.
    std::optional<double> rel_mse;
    std::optional<double> flip; // FLIP between the reference's two halves
    std::string lacks;          // light that it misses; empty if none is known
};

/// All results in one scene.
struct TransportScene {
    std::string name, shows; // the scene's purpose; empty for a scene that the user named
    std::string camera;      // describe_camera's text in the front end's words
    uint64_t triangles = 0;
    TransportReference reference;
    std::vector<TransportRow> rows;
    std::vector<std::string> notes;
    std::vector<ResultPicture> pictures; // the reference, then each integrator's last picture of its first repetition
    bool interrupted = false;
};

struct TransportReport {
    std::string device;
    uint32_t width = 0, height = 0, max_depth = 0, repetitions = 0, seed = 0;
    double seconds = 0; // rendering time of each integrator in each scene
    std::vector<TransportScene> scenes;
    bool interrupted = false;
};

/// A mean over repetitions. `half_width` belongs to its 95 % confidence interval by Student's t, which assumes
/// normally distributed values; absent for fewer than two values.
struct Estimate {
    double mean = 0;
    std::optional<double> half_width;
};

/// Estimates the mean of at least one value.
Estimate estimate_of(std::span<const double> values);
/// The 97.5 % quantile of Student's t distribution with `degrees` degrees of freedom, at least 1.
double student_t(uint32_t degrees);

/// Mean figures of an integrator at one number of samples or at one time.
struct TransportPoint {
    double samples = 0;
    Estimate seconds, rel_mse, flip;
    uint32_t repetitions = 0; // number of repetitions that contribute
    double patches = 0;       // mean over the displayed solutions
};

/// Returns a point for each number of samples that all repetitions have reached; empty without figures.
std::vector<TransportPoint> points_of(const TransportRow& row);

/// Returns the mean figures at a time, from the interpolated curve of each repetition. Interpolation is linear in the
/// logarithms of the value and of the sampling time (values of 0 are interpolated linearly). Absent if `seconds` lies
/// outside a repetition's figures or there are none. For solutions the last one that was ready is used.
std::optional<TransportPoint> at_time(const TransportRow& row, double seconds);

/// The longest time that all repetitions of all integrators with figures have reached; 0 if there is none. Solutions
/// are ignored unless there is nothing else.
double equal_seconds(const TransportScene& scene);

/// 1 / (relMSE seconds) from means; absent if either is 0. It is meaningless for light without noise.
std::optional<double> efficiency(const TransportPoint& point);

/// Returns, for example, "path, 1024 samples, 12.3 s; its noise: relMSE 1e-05".
std::string describe_reference(const TransportReference& reference);

/// Returns whether anything was measured.
bool has_findings(const TransportScene& scene);
bool has_findings(const TransportReport& report);

} // namespace pertev
