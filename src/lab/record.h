#pragma once

// The tables bench/jobs.json and bench/figures.json: scenes whose rays other tracers were timed on, jobs that other
// renderers were timed on, scenes that show what each integrator is good at, and what other programs reached on one
// card.

#include <array>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "math/vec3.h"
#include "settings/render_settings.h"

namespace pertev {

struct RecordView {
    Vec3 eye, target; // metres
    float fov_y_deg;  // full vertical angle of view
};

/// The record of other tracers for one set of 8,294,400 rays: the share that hit, nodes and triangles a ray
/// in a binary tree. A tracer that makes the same rays in the same scene has the same hit share.
struct RecordedSet {
    std::string name;
    double hit_share = 0, nodes = 0, triangles = 0;
    double best_rays_per_second = 0; // the best public tracer
};

struct RecordScene {
    std::string name;
    std::string file;       // under the folder of public scenes
    uint32_t triangles = 0; // number of triangles with an area
    RecordView view;
    std::vector<RecordedSet> sets; // in the order in which they are made
    double optix_fast_trace_s = 0,
           optix_fast_build_s = 0; // builds for fast tracing (not compacted), for fast building
};

struct RecordJob {
    std::string name;
    std::optional<float> reflectance; // if all surfaces are grey, under a sky of radiance 1
    std::optional<RecordView> view;   // the scene's own view, or one of the record; otherwise the file's
    PixelFilter filter = PixelFilter::Tent;
    std::optional<uint32_t> roulette_depth; // if it is Roulette::Throughput; otherwise the default
    uint32_t width = 0, height = 0, samples = 0;
    uint32_t max_depth = 0; // scatterings: one less than edges from the camera to a light
    // The scene is recognised by its triangles and by the mean over channels and pixels of others' pictures.
    uint64_t triangles = 0;
    double mean = 0;
    double mitsuba = 0, cycles = 0, pbrt = 0; // samples a second; 0 if unknown
};

struct TransportPreset {
    std::string name, scene; // a built-in scene
    std::string shows;
    std::string reference_integrator; // the one of path and bidirectional with less noise at equal time
    std::optional<RecordView> view;   // otherwise the scene's own camera is used
};

struct Record {
    std::string device;                   // device of all stored figures
    std::vector<RecordScene> scenes;      // sponza, bunny, forest
    std::vector<RecordJob> jobs;          // S5, S8, cornell-box-65, cornell-box-8, bunny, corridor
    std::vector<TransportPreset> presets; // cornell, caustic, blind, door, cove, many-lights
};

/// Returns the record, which is parsed at the first call.
const Record& the_record();

/// Returns the element with this name, or null.
template <class Named>
const Named* find_named(const std::vector<Named>& all, std::string_view name) {
    for (const Named& one : all) {
        if (one.name == name) return &one;
    }
    return nullptr;
}

} // namespace pertev
