#include "session/pictures/solve_scene.h"

#include <algorithm>
#include <memory>

#include <fmt/format.h>

#include "base/error.h"
#include "base/machine_memory.h"
#include "base/parallel_for.h"
#include "base/version.h"
#include "session/records/records_file.h"

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

namespace {

/// Solves the scene to the end. Throws Error(Interrupted) for a solution that the sink has ended, because a picture of
/// it could not be made again.
RadiositySolution solve_to_end(const PreparedScene& prepared, const RadiosityOptions& options, uint32_t seed,
                               Sink& sink, const SolveReport& report) {
    SolvedRadiosity solved = solve_scene(prepared, options, seed, sink, report);
    if (solved.stats.was_interrupted) {
        throw Error(ErrorCode::Interrupted, "interrupted while radiosity was being solved, so there is nothing "
                                            "to show (solving without a render keeps an unfinished solution)");
    }
    return std::move(solved.solution);
}

/// Returns the solution in the file of records, or makes it and writes it there.
RadiositySolution shared_solution(const PreparedScene& prepared, const RadiosityOptions& options, uint32_t seed,
                                  Sink& sink, const SolveReport& report) {
    const SolvedLight light = solved_light(*prepared.scene);
    const RecordsFile file(options.records, {{"version", fmt::format("{} {}", version(), git_commit())},
                                             {"integrator", "radiosity"},
                                             {"radiosity", json_of(settings_of(options, seed))},
                                             {"hash of the scene's geometry", geometry_hash(*prepared.scene).hex()},
                                             {"hash of the scene's surfaces", light.surfaces.hex()},
                                             {"hash of the scene's lights", light.lights.hex()}});
    if (const auto bytes = file.read()) return solution_of(*bytes, options.records, *prepared.scene);
    RadiositySolution solution = solve_to_end(prepared, options, seed, sink, report);
    file.write(bytes_of(solution));
    return solution;
}

} // namespace

RadiosityDisplay radiosity_display(const PreparedScene& prepared, const RadiosityOptions& options, uint32_t seed,
                                   Sink& sink, const SolveReport& report) {
    RadiositySolution solution;
    if (!options.solution.empty()) {
        solution = read_solution(options.solution, *prepared.scene, sink);
        sink.report_messages();
    } else {
        solution = (options.records.empty() ? solve_to_end : shared_solution)(prepared, options, seed, sink, report);
    }
    return {std::make_shared<const RadiositySolution>(std::move(solution)), options.flat_patches};
}

} // namespace pertev
