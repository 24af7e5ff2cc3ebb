#include "lab/stored_figures.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "math/portable_exp_log.h"

namespace pertev {
namespace {

constexpr double kMeanError = 2e-3;      // relative error of a picture's mean
constexpr double kShareError = 1e-3;     // error of the share of hits: the record has three digits
constexpr double kShareErrorAnew = 5e-2; // where the scene is made anew from a description

bool is_the_record(const RaysRun& run) {
    if (run.device != the_record().device || run.scene == nullptr) return false;
    const double share_error = !run.scene->file.empty() ? kShareError : kShareErrorAnew;
    return run.triangles == run.scene->triangles && run.rays == kRecordRays &&
           std::abs(run.hit_share - run.scene->sets[run.set].hit_share) <= share_error;
}

bool is_the_record(const BuildRun& run) {
    return run.device == the_record().device && run.scene != nullptr && run.triangles == run.scene->triangles;
}

bool is_the_record(const JobRun& run) {
    const RecordJob& job = *run.job;
    return run.device == the_record().device && run.width == job.width && run.height == job.height &&
           run.samples == job.samples && run.triangles == job.triangles &&
           std::abs(run.mean - job.mean) <= kMeanError * job.mean;
}

} // namespace

Ratio ratio_of(const RaysRun& run) {
    Ratio ratio = {"ratio_to_best", "ratio", {}};
    if (is_the_record(run)) ratio.value = run.rays_per_second / run.scene->sets[run.set].best_rays_per_second;
    return ratio;
}

std::vector<Ratio> ratios_of(const BuildRun& run) {
    const bool is_there = is_the_record(run);
    const auto ratio = [&](double RecordScene::*seconds) {
        return is_there ? std::optional(run.scene->*seconds / run.seconds) : std::nullopt;
    };
    return {{"ratio_to_optix_fast_trace", "to trace", ratio(&RecordScene::optix_fast_trace_s)},
            {"ratio_to_optix_fast_build", "to build", ratio(&RecordScene::optix_fast_build_s)}};
}

std::vector<Ratio> ratios_of(const JobRun& run) {
    const bool is_there = is_the_record(run);
    const auto ratio = [&](double RecordJob::*rate) {
        return is_there ? std::optional(run.samples_per_second / run.job->*rate) : std::nullopt;
    };
    return {{"ratio_to_mitsuba", "times Mitsuba 3", ratio(&RecordJob::mitsuba)},
            {"ratio_to_cycles", "times Cycles", ratio(&RecordJob::cycles)},
            {"ratio_to_pbrt", "times pbrt-v4", ratio(&RecordJob::pbrt)}};
}

ResultField field_of(const Ratio& ratio) { return {ratio.key, ratio.title, ratio.value, "", "{:.2f}"}; }

std::string why_no_ratios(const RecordJob& job) {
    return fmt::format(
        "no ratios to others: their figures are of one {}, {}x{}, {} spp, {} triangles and a mean of {}\n",
        the_record().device, job.width, job.height, job.samples, job.triangles, job.mean);
}

RatioSummary summarize(std::span<const double> ratios) {
    float sum = 0;
    for (const double ratio : ratios) sum += log(static_cast<float>(ratio));
    return {static_cast<double>(exp(sum / static_cast<float>(ratios.size()))), *std::ranges::min_element(ratios)};
}

} // namespace pertev
