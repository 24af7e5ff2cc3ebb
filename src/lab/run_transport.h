#pragma once

// The laboratory of light transport: makes a reference, or takes one, and lets each integrator render the same picture
// several times, for the same time each.

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

inline constexpr uint32_t kMostRepetitions = 1024;

struct TransportSettings {
    std::string camera;                   // describe_camera in the words of the front end, for the report
    std::vector<std::string> integrators; // names (settings/value_names.h)
    uint32_t repetitions = 4;             // [1, kMostRepetitions]
    double seconds = 10;                  // of rendering for each integrator, all repetitions together
    uint32_t max_samples = 1u << 16;      // of each pixel, of one repetition
    uint32_t max_solutions = 16;          // of radiosity, of one repetition
    RenderSettings picture;               // size, depth, filter, and the first seed; the integrator is not looked at
    std::optional<Image> reference;       // given; none: it is made by
    std::string reference_file;           // name of the one given
    std::string reference_integrator = "path";
    uint32_t reference_samples = 1024; // at least 2; an odd one is one fewer
};

/// Seed of a repetition. Those of the reference's two halves are none of these, for at most kMostRepetitions.
inline uint32_t repetition_seed(const TransportSettings& settings, uint32_t repetition) {
    return settings.picture.path.seed + repetition;
}
inline uint32_t reference_seed(const TransportSettings& settings, uint32_t half) {
    return settings.picture.path.seed + 0x80000000u + half;
}

/// Samples of the picture after `last`, the first repetition's: twice as many where they come within `share_s`, else as
/// many as do, where those are an eighth more at least; 0: none. What is made before the first sample (made_seconds) is
/// there and takes no time again. At most `most`.
uint32_t next_samples(const TransportFigures& last, double share_s, uint32_t most);

/// A sample of each pixel that no figures count, so that memory, caches and the driver's first launches are not timed.
/// Where the integrator makes something before samples it is ended once that has begun: it is made once, and timed.
/// The film begins anew. Throws as Session::render.
void warm_up(Session& session, const std::function<void()>& tell = {});

/// All integrators take their first turn, then all their second, and so on: so an interrupt leaves something of each.
/// The first repetition of an integrator goes on to 1, 2, 4, ... samples as long as the next fits into its share of the
/// time (one sample is always rendered), and then to as many as do; the others have the same numbers. Radiosity has
/// solutions of growing detail in their place (lab/transport_solutions.h), as long as the next would fit into the share
/// by itself. One that cannot render this scene is refused in its row. `scene` has been through validate(). Stops
/// early, with `interrupted` set, when keep_going returns false; the repetition that was under way is kept where it is
/// an integrator's first. Throws Error(BadInput) where the reference given has another size or is not finite, or the
/// reference's integrator cannot render the scene; what Session throws of the device.
TransportScene run_transport(Queue& queue, const Scene& scene, const Camera& camera, const TransportSettings& settings,
                             const std::function<bool(const LabProgress&)>& keep_going);

} // namespace pertev
