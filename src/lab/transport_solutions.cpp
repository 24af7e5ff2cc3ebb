#include "lab/transport_solutions.h"

#include <memory>

#include "base/error.h"
#include "base/parallel_for.h"
#include "base/stopwatch.h"
#include "integrators/radiosity/radiosity_display_settings.h"
#include "radiosity/solve_memory.h"
#include "session/session.h"

namespace pertev {
namespace {

constexpr uint32_t kFirstPatch = 4; // first patches relative to the default's edge
constexpr std::size_t kMaxSolutionBytes = std::size_t(4) << 30;

} // namespace

RadiositySettings solution_settings(const PreparedScene& prepared, uint32_t number, uint32_t seed) {
    RadiositySettings settings;
    settings.patch_size = patch_size_of(prepared, settings) * kFirstPatch / static_cast<float>(1u << number);
    settings.subdivisions = 1; // more subdivisions would make each solution cost as much as the next
    settings.seed = seed;
    return settings;
}

bool may_be_solved(const PreparedScene& prepared, uint32_t number) {
    try {
        const RadiositySettings settings = solution_settings(prepared, number, 0);
        return predict_memory(prepared, settings, thread_count()).bytes <= kMaxSolutionBytes;
    } catch (const Error& error) {
        if (error.code() != ErrorCode::OverLimit) throw;
        return false; // too many patches
    }
}

SolvedPicture solve_picture(Queue& queue, const PreparedScene& prepared, const Camera& camera, RenderSettings settings,
                            uint32_t number, uint32_t samples, Sink& sink) {
    const Stopwatch watch;
    SolvedRadiosity solved = solve_radiosity(prepared, solution_settings(prepared, number, settings.path.seed), sink);
    SolvedPicture shown;
    shown.figures.seconds = watch.seconds();
    shown.figures.samples = samples;
    shown.figures.patches = solved.stats.shown;
    shown.host_bytes = solved.stats.bytes + solved.solution.bytes();
    settings.radiosity = {std::make_shared<const RadiositySolution>(std::move(solved.solution)), false};
    const std::size_t before = queue.allocated_bytes();
    Session session(queue, prepared, camera, settings);
    const auto render = [&](uint32_t count) {
        double seconds = 0;
        session.render(count, ProgressSink([&](const Progress& now) {
                           seconds = now.seconds;
                           Progress rendering = now;
                           rendering.doing = "rendering";
                           return sink.goes_on(rendering);
                       }));
        return seconds;
    };
    render(1); // memory allocation, caches and the driver's first launch are not timed
    session.cut();
    shown.figures.seconds += render(samples);
    shown.picture = session.picture();
    shown.device_bytes = queue.allocated_bytes() - before;
    shown.invalid_samples = session.stats().invalid_samples;
    return shown;
}

} // namespace pertev
