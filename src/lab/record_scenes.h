#pragma once

// Makers of what bench/jobs.json describes (lab/record.h): scenes of the five sets of rays that other tracers were
// timed on (docs/ray_sets.md), jobs that other renderers were timed on, and cameras of presets.
//
// S5, S8: the triangles of Crytek's Sponza, seen as rays on the record are (lab/record_scenes.h), in a 0.7 grey that
// scatters to both sides, without vertex normals, under radiance 1 from everywhere; box filter of one pixel, at most 5
// or 8 scatterings, Russian roulette by throughput from the second on. cornell-box-65, cornell-box-8: Bitterli's
// Cornell box as its file has it (tests/images/mitsuba_to_gltf.py makes a glTF of that), tent filter of radius 1, at
// most 65 or 8 edges from the camera to a light; roulette as in any picture.

#include <filesystem>
#include <string>

#include "base/sink.h"
#include "lab/record.h"
#include "scene/scene.h"
#include "session/opening/choose_camera.h"
#include "settings/render_settings.h"

namespace pertev {

inline constexpr uint32_t kRecordRays = 8294400; // four frames of 1920 x 1080

Camera record_camera(const RecordScene& scene);

/// Returns the scene's file, below the folder of public scenes (docs/scenes.md). Throws Error(BadInput) if it does not
/// exist.
std::filesystem::path record_file(const RecordScene& scene, const std::filesystem::path& folder);

/// Reads a scene of the record: geometry in one mesh, grey, with the camera. Throws like record_file.
Scene make_record_scene(const RecordScene& scene, const std::filesystem::path& folder, Sink& sink);

/// Returns the settings of a job: size, samples, filter and depth.
RenderSettings job_settings(const RecordJob& job);

/// Reads the job's scene from the file that has its geometry. Throws Error.
Scene make_job_scene(const RecordJob& job, const std::string& file, Sink& sink);

/// Returns the job's camera for pictures of this width / height. Throws Error(BadInput).
Camera job_camera(const RecordJob& job, const Scene& scene, float aspect, Sink& sink);

/// Returns the preset's own view; all defaults if it has none.
CameraChoice camera_choice(const TransportPreset& preset);

} // namespace pertev
