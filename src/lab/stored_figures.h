#pragma once

// Comparison with stored figures (bench/figures.json): what public tracers, builders and renderers reached on one
// NVIDIA H200 at what `pertev bench rays`, `build` and `render` measure. A run is on the record only if device, scene
// and job are those of the figure:
// - the device has the card's very name: "NVIDIA H200 NVL" is another card, and a slice of one has a name of its own;
// - a set of rays is of a scene of the record (by its name, its camera and its triangles), has all of the record's
//   8,294,400 rays, and they hit as often: to the record's third digit, but to 0.05 in the forest,
//   which is remade from its description in the record (docs/ray_sets.md);
// - a build is of a scene of the record, by its name and its triangles;
// - a render job has its own name, size, samples and triangles, and the picture's mean is theirs to 0.2 %.

#include <span>
#include <string>
#include <string_view>

#include "lab/measurement.h"
#include "lab/record_scenes.h"

namespace pertev {

/// Returns whether a build of this many triangles is on the record. `scene` is null for a scene that is not.
bool is_on_record(std::string_view device, const RecordScene* scene, uint64_t triangles);
/// Returns whether rays of set number `set`, seen by the scene's own camera, are on the record.
bool is_on_record(std::string_view device, const RecordScene* scene, uint64_t triangles, std::size_t set, uint64_t rays,
                  double hit_share);
/// Returns whether a picture of this mean over all pixels and channels is on the record.
bool is_on_record(std::string_view device, const RecordJob& job, const RenderSettings& settings, uint64_t triangles,
                  double mean);

/// Makes the field of a ratio: how many times as fast as the stored figure a run is, if it is on the record; otherwise
/// nothing.
ResultField ratio_field(const char* key, const char* title, bool is_on_record, double ratio);
/// Returns a line for people that states which scene and settings the stored figures of this job belong to.
std::string why_no_ratios(const RecordJob& job);

/// Summary of at least one ratio.
struct RatioSummary {
    double geometric_mean, least;
};
RatioSummary summarize(std::span<const double> ratios);

} // namespace pertev
