#include "session/pictures/solve_scene.h"

#include <algorithm>
#include <memory>

#include "base/error.h"
#include "base/machine_memory.h"
#include "base/parallel_for.h"

namespace pertev {
namespace {

RadiositySettings settings_of(const RadiosityOptions& options, uint32_t seed) {
    RadiositySettings settings = options.solving;
    settings.seed = seed;
    settings.hemicube = settings.hemicube / 2 * 2; // the sides have half of them
    return settings;
}

} // namespace

std::optional<std::size_t> max_memory_bytes(const RadiosityOptions& options) {
    if (!(options.max_memory > 0)) return std::nullopt;
    return static_cast<std::size_t>(std::min(options.max_memory * 0x1p20, 0x1p62));
}

SolvedRadiosity solve_scene(const PreparedScene& prepared, const RadiosityOptions& options, uint32_t seed, Sink& sink,
                            const SolveReport& report) {
    const RadiositySettings settings = settings_of(options, seed);
    sink.set_work("solving radiosity");
    const SolveMemory memory = predict_memory(prepared, settings, thread_count());
    if (report.begin) report.begin(memory, patch_size_of(prepared, settings));
    check_memory(memory, settings, max_memory_bytes(options).value_or(machine_memory_bytes()));
    SolvedRadiosity solved = solve_radiosity(prepared, settings, sink);
    if (report.end) report.end(solved);
    warn_of_limits(solved.stats, settings, sink);
    sink.report_messages();
    return solved;
}

RadiosityDisplay radiosity_display(const PreparedScene& prepared, const RadiosityOptions& options, uint32_t seed,
                                   Sink& sink, const SolveReport& report) {
    RadiositySolution solution;
    if (!options.solution.empty()) {
        solution = read_solution(options.solution, *prepared.scene, sink);
        sink.report_messages();
    } else {
        SolvedRadiosity solved = solve_scene(prepared, options, seed, sink, report);
        if (solved.stats.was_interrupted) { // a picture of it could not be made again
            throw Error(ErrorCode::Interrupted, "interrupted while radiosity was being solved, so there is nothing "
                                                "to show (solving without a render keeps an unfinished solution)");
        }
        solution = std::move(solved.solution);
    }
    return {std::make_shared<const RadiositySolution>(std::move(solution)), options.flat_patches};
}

} // namespace pertev
