#include "lab/stored_figures.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "math/portable_exp_log.h"

namespace pertev {

bool is_on_record(std::string_view device, const RecordScene* scene, uint64_t triangles) {
    return device == the_record().device && scene != nullptr && triangles == scene->triangles;
}

bool is_on_record(std::string_view device, const RecordScene* scene, uint64_t triangles, std::size_t set, uint64_t rays,
                  double hit_share) {
    if (!is_on_record(device, scene, triangles) || rays != kRecordRays) return false;
    const double error = scene->name == "forest" ? 5e-2 : 1e-3;
    return std::abs(hit_share - scene->sets[set].hit_share) <= error;
}

bool is_on_record(std::string_view device, const RecordJob& job, const RenderSettings& settings, uint64_t triangles,
                  double mean) {
    return device == the_record().device && settings.width == job.width && settings.height == job.height &&
           settings.samples == job.samples && triangles == job.triangles &&
           std::abs(mean - job.mean) <= 2e-3 * job.mean;
}

ResultField ratio_field(const char* key, const char* title, bool is_on_record, double ratio) {
    return {key, title, is_on_record ? ResultCell(ratio) : ResultCell(), "", "{:.2f}"};
}

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
