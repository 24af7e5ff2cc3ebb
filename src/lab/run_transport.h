#pragma once

// The light transport laboratory: makes or accepts a reference, then lets each integrator render the same view
// several times, each for the same time.

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "device/queue.h"
#include "image/image.h"
#include "lab/run_lab.h"
#include "lab/transport_report.h"
#include "scene/scene.h"
#include "session/session.h"
#include "settings/render_settings.h"

namespace pertev {

inline constexpr uint32_t kMaxRepetitions = 1024;

struct TransportSettings {
    std::string camera;                   // describe_camera's text in the front end's words, for the report
    std::vector<std::string> integrators; // names (settings/value_names.h)
    uint32_t repetitions = 4;             // [1, kMaxRepetitions]
    double seconds = 10;                  // rendering time of each integrator over all repetitions
    uint32_t max_samples = 1u << 16;      // largest number of samples per pixel in a repetition
    uint32_t max_solutions = 16;          // largest number of radiosity solutions in a repetition
    RenderSettings picture;               // size, depth, filter and first seed; its integrator is ignored
    std::optional<Image> reference;       // a given reference; if absent, `reference_integrator` renders one
    std::string reference_file;           // file name of a given reference
    std::string reference_integrator = "path";
    uint32_t reference_samples = 1024; // at least 2; an odd number is rounded down
};

/// Returns the seed of a repetition. The seeds of the reference's halves differ from all of these, for at most
/// kMaxRepetitions.
inline uint32_t repetition_seed(const TransportSettings& settings, uint32_t repetition) {
    return settings.picture.path.seed + repetition;
}
inline uint32_t reference_seed(const TransportSettings& settings, uint32_t half) {
    return settings.picture.path.seed + 0x80000000u + half;
}

/// Returns the number of samples of the next picture after `last`, at most `most`: twice as many if they fit into
/// `share_s` seconds, otherwise as many as fit if that is at least an eighth more, otherwise 0. made_seconds is already
/// spent and not counted again.
uint32_t next_samples(const TransportFigures& last, double share_s, uint32_t most);

/// Renders one uncounted sample per pixel, so that memory allocation, caches and the driver's first launches are not
/// timed. If the integrator prepares something before its samples, rendering stops once that has begun: it is made
/// only once and timed. The film is cleared afterwards. Throws what Session::render throws.
void warm_up(Session& session, const std::function<void()>& report = {});

/// Lets all integrators take their first turn, then all their second, and so on, so that an interrupt leaves results
/// of each. An integrator's first repetition has 1, 2, 4, ... samples as long as the next picture fits into its share
/// of the time (one sample is always rendered), and then as many as fit; its other repetitions use these numbers.
/// Radiosity makes solutions of growing detail instead (lab/transport_solutions.h), while the next alone would fit into
/// the share. An integrator that cannot render the scene is refused in its row. `scene` must have passed validate().
/// Stops early, with `interrupted` set, when `sink` stops; an unfinished repetition is kept if it is an
/// integrator's first. Throws Error(BadInput) if a given reference has another size or is not finite, or if the
/// reference's integrator cannot render the scene, and the device errors that Session throws.
TransportScene run_transport(Queue& queue, const Scene& scene, const Camera& camera, const TransportSettings& settings,
                             Sink& sink = nobody());

} // namespace pertev
