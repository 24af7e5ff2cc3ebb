#include "lab/stored_figures.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/error.h"
#include "math/portable_exp_log.h"

namespace pertev {
namespace {

// Measured on one NVIDIA H200 (132 multiprocessors at 1980 MHz; driver 580.159.04, CUDA 13.0), each program by itself.

/// Rays: medians of 25 runs of the best of ports of Aila and Laine's GPURayTraversal (AL, both of its kernels),
/// tinybvh, AlanIWBFT/CWBVH (cw-alan) and GPU-Raytracer (cw-gpurt), of cuBQL and OptiX 9. Builds: OptiX 9 in the
/// driver's software, warm, seconds.
struct SceneFigures {
    std::string_view scene;
    double best_rays_per_second[5]; // in the order of RecordScene::sets
    double optix_fast_trace_s, optix_fast_build_s;
};

constexpr std::array kSceneFigures = {
    // AL, AL, AL, cw-alan, cw-alan
    SceneFigures{"sponza", {5524e6, 3479e6, 2306e6, 2173e6, 2233e6}, 1.48e-3, 0.31e-3},
    // AL, cw-gpurt, cw-alan, cw-alan, cw-gpurt
    SceneFigures{"bunny", {7110e6, 4384e6, 4239e6, 5190e6, 5416e6}, 3.70e-3, 0.95e-3},
    // AL, cw-gpurt, cw-alan, cw-gpurt, cw-gpurt
    SceneFigures{"forest", {2729e6, 2087e6, 1548e6, 1451e6, 1449e6}, 20.1e-3, 6.06e-3},
};

/// Samples a second, without loading and writing: Mitsuba 3.9.1 (cuda_ad_rgb) and pbrt-v4 (5f7a606), both through OptiX
/// in the driver's software, and Cycles 5.0.1, with a sky that it samples as a light, through its own trees (S5:
/// through OptiX, 46e6 through its own).
struct JobFigures {
    std::string_view job;
    double mitsuba, cycles, pbrt;
};

constexpr std::array kJobFigures = {
    JobFigures{"S5", 109.7e6, 50e6, 72e6},
    JobFigures{"S8", 86.4e6, 41e6, 61e6},
    JobFigures{"cornell-box-65", 169.8e6, 132e6, 64e6},
    JobFigures{"cornell-box-8", 184.9e6, 135e6, 124e6},
};

constexpr double kMeanError = 2e-3;      // of a picture, relative
constexpr double kShareError = 1e-3;     // of rays that hit: the record has three digits
constexpr double kShareErrorAnew = 5e-2; // where the scene is made anew from a description

const SceneFigures& figures_of(const RecordScene& scene) {
    const auto found = std::ranges::find(kSceneFigures, scene.name, &SceneFigures::scene);
    PERTEV_CHECK(found != kSceneFigures.end());
    return *found;
}

const JobFigures& figures_of(const RecordJob& job) {
    const auto found = std::ranges::find(kJobFigures, job.name, &JobFigures::job);
    PERTEV_CHECK(found != kJobFigures.end());
    return *found;
}

bool is_the_record(const RaysRun& run) {
    if (run.device != kFiguresDevice || run.scene == nullptr) return false;
    const double share_error = run.scene->file != nullptr ? kShareError : kShareErrorAnew;
    return run.triangles == run.scene->triangles && run.rays == kRecordRays &&
           std::abs(run.hit_share - run.scene->sets[run.set].hit_share) <= share_error;
}

bool is_the_record(const BuildRun& run) {
    return run.device == kFiguresDevice && run.scene != nullptr && run.triangles == run.scene->triangles;
}

bool is_the_record(const JobRun& run) {
    const RecordJob& job = *run.job;
    return run.device == kFiguresDevice && run.width == job.width && run.height == job.height &&
           run.samples == job.samples && run.triangles == job.triangles &&
           std::abs(run.mean - job.mean) <= kMeanError * job.mean;
}

} // namespace

double best_rays_per_second(const RecordScene& scene, std::size_t set) {
    return figures_of(scene).best_rays_per_second[set];
}

Ratio ratio_of(const RaysRun& run) {
    Ratio ratio{"the best public tracer", "best", {}};
    if (is_the_record(run)) ratio.value = run.rays_per_second / best_rays_per_second(*run.scene, run.set);
    return ratio;
}

std::vector<Ratio> ratios_of(const BuildRun& run) {
    std::vector<Ratio> ratios = {{"OptiX, fast tracing", "optix_fast_trace", {}},
                                 {"OptiX, fast building", "optix_fast_build", {}}};
    if (is_the_record(run)) {
        const SceneFigures& figures = figures_of(*run.scene);
        ratios[0].value = figures.optix_fast_trace_s / run.seconds;
        ratios[1].value = figures.optix_fast_build_s / run.seconds;
    }
    return ratios;
}

std::vector<Ratio> ratios_of(const JobRun& run) {
    std::vector<Ratio> ratios = {{"Mitsuba 3", "mitsuba", {}}, {"Cycles", "cycles", {}}, {"pbrt-v4", "pbrt", {}}};
    if (is_the_record(run)) {
        const JobFigures& figures = figures_of(*run.job);
        ratios[0].value = run.samples_per_second / figures.mitsuba;
        ratios[1].value = run.samples_per_second / figures.cycles;
        ratios[2].value = run.samples_per_second / figures.pbrt;
    }
    return ratios;
}

std::string ratios_json(std::span<const Ratio> ratios) {
    std::vector<std::string> members;
    for (const Ratio& ratio : ratios) {
        members.push_back(
            fmt::format(R"("ratio_to_{}":{})", ratio.key, ratio.value ? fmt::format("{:.4f}", *ratio.value) : "null"));
    }
    return fmt::format("{}", fmt::join(members, ","));
}

std::string ratio_cell(const Ratio& ratio) { return ratio.value ? fmt::format("{:.2f}", *ratio.value) : "-"; }

std::string ratios_line(std::span<const Ratio> ratios, const RecordJob& job) {
    std::vector<std::string> parts;
    for (const Ratio& ratio : ratios) {
        if (ratio.value) parts.push_back(fmt::format("{:.2f} times {}", *ratio.value, ratio.program));
    }
    if (!parts.empty()) return fmt::format("{}, as stored of one {}", fmt::join(parts, ", "), kFiguresDevice);
    return fmt::format("no ratios to others: their figures are of one {}, {}x{}, {} spp, {} triangles and a mean of {}",
                       kFiguresDevice, job.width, job.height, job.samples, job.triangles, job.mean);
}

RatioSummary summarize(std::span<const double> ratios) {
    float sum = 0;
    for (const double ratio : ratios) sum += log(static_cast<float>(ratio));
    return {static_cast<double>(exp(sum / static_cast<float>(ratios.size()))), *std::ranges::min_element(ratios)};
}

} // namespace pertev
