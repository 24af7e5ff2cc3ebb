#pragma once

// Ratios to stored figures (bench/figures.json): what public tracers, builders and renderers reached on one NVIDIA H200
// at what `pertev bench rays`, `build` and `render` measure, and our rates over theirs: above 1 ours is faster. There
// is a ratio only where device, scene and job are those of the figure:
// - the device has the card's very name: "NVIDIA H200 NVL" is another card, and a slice of one has a name of its own;
// - a set of rays is of a scene of the record (by its name, its camera and its triangles), has all of the record's
//   8,294,400 rays, and they hit as often: to the record's third digit in scenes of a file, to 0.05 in the forest,
//   which is made anew from what the record says of it (docs/ray_sets.md);
// - a build is of a scene of the record, by its name and its triangles;
// - a render job has its own name, size, samples and triangles, and the picture's mean is theirs to 0.2 %.

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "lab/measurement.h"
#include "lab/record_scenes.h"

namespace pertev {

struct Ratio {
    const char *key, *title;
    std::optional<double> value; // nothing: device, scene or job are not the figure's
};

// A run has its result and the facts that decide whether a figure is of the same thing.

struct RaysRun {
    std::string_view device;
    const RecordScene* scene = nullptr; // seen by its own camera; null: none of the record
    std::size_t set = 0;                // index into RecordScene::sets
    uint64_t triangles = 0, rays = 0;
    double hit_share = 0, rays_per_second = 0;
};

struct BuildRun {
    std::string_view device;
    const RecordScene* scene = nullptr;
    uint64_t triangles = 0;
    double seconds = 0;
};

struct JobRun {
    std::string_view device;
    const RecordJob* job = nullptr;
    uint32_t width = 0, height = 0, samples = 0; // samples per pixel
    uint64_t triangles = 0;
    double mean = 0, samples_per_second = 0; // mean over all pixels
};

/// To the best public tracer.
Ratio ratio_of(const RaysRun& run);
/// To OptiX's builds for fast tracing (not compacted) and for fast building.
std::vector<Ratio> ratios_of(const BuildRun& run);
/// To Mitsuba 3, Cycles and pbrt-v4.
std::vector<Ratio> ratios_of(const JobRun& run);

ResultField field_of(const Ratio& ratio);
/// A line for people: what the figures of this job are of.
std::string why_no_ratios(const RecordJob& job);

/// Summary of at least one ratio.
struct RatioSummary {
    double geometric_mean, least;
};
RatioSummary summarize(std::span<const double> ratios);

} // namespace pertev
