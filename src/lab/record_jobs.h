#pragma once

// Jobs that other renderers were timed on, so defined that any renderer can do the same. What they reached is in
// lab/stored_figures.h.
//
// S5, S8: the triangles of Crytek's Sponza, seen as rays on the record are (lab/record_scenes.h), in a 0.7 grey that
// scatters to both sides, without vertex normals, under radiance 1 from everywhere; box filter of one pixel, at most 5
// or 8 scatterings, Russian roulette by throughput from the second on. cornell-box-65, cornell-box-8: Bitterli's
// Cornell box as its file has it (tests/images/mitsuba_to_gltf.py makes a glTF of that), tent filter of radius 1, at
// most 65 or 8 edges from the camera to a light; roulette as in any picture.

#include <span>
#include <string>
#include <string_view>

#include "base/messages.h"
#include "scene/scene.h"
#include "settings/render_settings.h"

namespace pertev {

struct RecordJob {
    const char* name;
    bool is_grey; // S5, S8
    uint32_t width, height, samples;
    uint32_t max_depth; // scatterings: one less than edges from the camera to a light
    // What tells the scene: its triangles, and the mean over channels and pixels of others' pictures.
    uint64_t triangles;
    double mean;
};

std::span<const RecordJob> record_jobs();
/// Null where none has this name.
const RecordJob* find_record_job(std::string_view name);

/// Size, samples, filter and depth of the job.
RenderSettings job_settings(const RecordJob& job);

/// The job's scene, of the file that has its geometry. Throws Error.
Scene make_job_scene(const RecordJob& job, const std::string& file, Messages& messages);

/// For pictures of this width / height. Throws Error(BadInput).
Camera job_camera(const RecordJob& job, const Scene& scene, float aspect, Messages& messages);

} // namespace pertev
