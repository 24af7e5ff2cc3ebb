#include "tests/support/small_lab_report.h"

#include <doctest/doctest.h>

namespace pertev::test {

CombinationFigures figures(const Combination& c, std::vector<RunFigures> runs) {
    return {.combination = c, .structure = 0, .name = name_of(c), .runs = std::move(runs)};
}

RunFigures timed(uint32_t set, double seconds) {
    return {.set = set, .median_s = seconds, .min_s = seconds, .largest_s = seconds};
}

LabReport small_report() {
    LabReport report;
    report.scene = "a \"quoted\", scene <&>";
    report.device = "CPU", report.camera = "at <1, 2, 3>";
    report.triangles = 1000, report.width = 4, report.height = 2, report.runs = 20, report.warm_ups = 1;
    report.sets = {{.name = "primary", .depth = 1, .rays = 8'000'000, .hit_share = 0.5, .brute_force_rays = 2200},
                   {.name = "shadow", .any_hit = true, .rays = 4'000'000},
                   {.name = "diffuse1", .depth = 2, .rays = 2'000'000}};
    report.structures = {{.name = "binned",
                          .build_s = 0.25,
                          .nodes = 999,
                          .triangles = 1000,
                          .bytes = 64'000,
                          .sah_cost = 12,
                          .depth = 9}};
    CombinationFigures all = figures({}, {timed(0, 2), timed(1, 1), timed(2, 0.5)});
    all.runs[0].min_s = 1, all.runs[0].largest_s = 4, all.runs[0].nodes = 10, all.runs[0].triangles = 0;
    const Combination kd = {.traversal = TraversalKind::Kd};
    report.combinations = {all, {.combination = kd, .name = name_of(kd), .refused = "no <planes>, none"}};
    HeatMap map = {all.name, 4e6, 4, 2, {0, 1, 2, 3, 4, 5, 6, 7}, {7, 6, 5, 4, 3, 2, 1, 0}};
    report.heat_maps.push_back(map);
    return report;
}

bool has(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

std::size_t count(const std::string& text, const std::string& part) {
    std::size_t n = 0;
    for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + part.size())) ++n;
    return n;
}

std::string line_with(const std::string& text, const std::string& part) {
    const std::size_t at = text.find(part);
    REQUIRE_MESSAGE(at != std::string::npos, part);
    const std::size_t begin = text.rfind('\n', at) + 1;
    return text.substr(begin, text.find('\n', at) - begin);
}

} // namespace pertev::test
