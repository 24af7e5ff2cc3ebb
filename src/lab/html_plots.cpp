#include "lab/html_plots.h"

#include <algorithm>
#include <array>

#include <fmt/format.h>

#include "lab/heat_map.h"
#include "lab/svg_plot.h"
#include "lab/write_html.h"

namespace pertev {
namespace {

constexpr std::size_t kBars = 30, kCurves = 10;

enum class Family : uint32_t { BinaryStack, Stackless, Packet, Wide, Cells, BruteForce };
constexpr std::array kFamilies = {"binary, with a stack", "binary, stackless",  "packets",
                                  "wide and compressed",  "kd-tree and octree", "brute force"};

Family family_of(WalkKind walk) {
    switch (walk) {
    case WalkKind::IfIf:
    case WalkKind::WhileWhile:
    case WalkKind::Speculative:
    case WalkKind::Octants:
        return Family::BinaryStack;
    case WalkKind::RestartTrail:
    case WalkKind::ShortStack:
    case WalkKind::ParentLinks:
    case WalkKind::SkipLinks:
        return Family::Stackless;
    case WalkKind::Packet:
        return Family::Packet;
    case WalkKind::Wide4:
    case WalkKind::Wide8:
    case WalkKind::Wide8Simd:
    case WalkKind::Compressed:
        return Family::Wide;
    case WalkKind::Kd:
    case WalkKind::Octree:
        return Family::Cells;
    case WalkKind::BruteForce:
        break;
    }
    return Family::BruteForce;
}

std::string bars_of(const LabReport& report, uint32_t set) {
    std::vector<Bar> bars;
    for (const CombinationFigures& c : report.combinations) {
        const RunFigures* run = find_run(c, set);
        if (run == nullptr || run->is_copy || c.wrong || !(run->least_s > 0)) continue;
        const double rays = static_cast<double>(report.sets[set].rays) * 1e-6;
        const BarStyle style = {static_cast<uint32_t>(family_of(c.combination.walk)),
                                !c.combination.options.is_exact()};
        bars.push_back({c.name, rays / run->median_s, rays / run->largest_s, rays / run->least_s, style});
    }
    std::ranges::stable_sort(bars, [](const Bar& a, const Bar& b) { return a.value > b.value; });
    const std::size_t all = bars.size();
    bars.resize(std::min(all, kBars));
    std::vector<BarLegend> legend;
    for (uint32_t i = 0; i < kFamilies.size(); ++i) {
        if (std::ranges::any_of(bars, [i](const Bar& bar) { return bar.style.color == i; })) {
            legend.push_back({kFamilies[i], {i, false}});
        }
    }
    if (std::ranges::any_of(bars, [](const Bar& bar) { return bar.style.is_hollow; })) {
        legend.push_back({"hollow: fast tests and Woop's, which lose rays at edges", {kBarColors - 2, true}}); // grey
    }
    std::string html = svg_bars(report.sets[set].name, "Mrays/s", bars, legend);
    if (all > kBars) html += fmt::format("<p>The {} fastest of {}; the table below has all.</p>\n", kBars, all);
    return html;
}

/// Seconds of the largest frame; none where that is not a figure of its own.
std::optional<double> whole_frame_seconds(const LabReport& report, const CombinationFigures& c) {
    const bool copied = std::ranges::any_of(
        c.runs, [&](const RunFigures& run) { return run.is_copy && report.sets[run.set].depth > 0; });
    if (c.wrong || copied || !c.combination.options.is_exact()) return std::nullopt;
    return frame_seconds(report, c, largest_depth(report));
}

} // namespace

std::string html_bars(const LabReport& report) {
    std::string html;
    for (uint32_t set = 0; set < report.sets.size(); ++set) html += bars_of(report, set);
    if (html.empty()) return {};
    return "<h2>Million rays a second</h2>\n<p>Bars are medians, whiskers reach from the slowest run to the "
           "fastest.</p>\n" +
           html;
}

std::string html_curves(const LabReport& report) {
    const int depths = largest_depth(report);
    if (depths <= report.first_depth) return {};
    std::vector<const CombinationFigures*> complete;
    for (const CombinationFigures& c : report.combinations) {
        if (whole_frame_seconds(report, c)) complete.push_back(&c);
    }
    if (complete.empty()) return {};
    std::ranges::stable_sort(complete, [&](const CombinationFigures* a, const CombinationFigures* b) {
        return *whole_frame_seconds(report, *a) < *whole_frame_seconds(report, *b);
    });
    const bool all = complete.size() <= kCurves;
    complete.resize(std::min(complete.size(), kCurves));
    std::vector<Curve> rates, frames;
    for (const CombinationFigures* c : complete) {
        Curve rate = {c->name, {}}, frame = {c->name, {}};
        for (int depth = report.first_depth; depth <= depths; ++depth) {
            const std::optional<double> seconds = frame_seconds(report, *c, depth);
            if (!seconds) continue;
            frame.points.emplace_back(depth, 1 / *seconds);
            rate.points.emplace_back(depth, static_cast<double>(frame_rays(report, depth)) / *seconds * 1e-6);
        }
        rates.push_back(rate), frames.push_back(frame);
    }
    const std::string which = fmt::format("{} with exact tests", all ? "all" : fmt::format("the {} fastest", kCurves));
    return "<h2>Over the depth of paths</h2>\n" + svg_curves("Rays a second, " + which, "depth", "Mrays/s", rates) +
           svg_curves("Frames a second, " + which, "depth", "frames/s", frames);
}

std::string html_heat_maps(const LabReport& report) {
    if (report.heat_maps.empty()) return {};
    const std::vector<HeatMap>& maps = report.heat_maps;
    // One scale for all, so that pictures can be compared.
    uint32_t most_nodes = 1, most_triangles = 1;
    for (const HeatMap& map : maps) {
        most_nodes = std::max(most_nodes, scale_end(map.nodes));
        most_triangles = std::max(most_triangles, scale_end(map.triangles));
    }
    std::string html = "<h2>Tests a pixel, camera rays</h2>\n<p>Dark is little, pale yellow is the number at the right "
                       "end of the scale or more; one scale for all pictures of nodes, one for all of triangles. Each "
                       "structure and walk has one, of its first combination, which has the most switches on.";
    if (maps.size() < report.heat_map_names.size()) {
        html += fmt::format(" Here are those of the {} that were fastest at camera rays, of {}; all are PNG files "
                            "beside this report, each on a scale of its own.",
                            maps.size(), report.heat_map_names.size());
    }
    html += "</p>\n";
    for (const HeatMap& map : maps) {
        html += html_image(draw_heat_map(map.nodes, map.width, map.height, most_nodes), map.name + ": nodes", 512);
        html += html_image(draw_heat_map(map.triangles, map.width, map.height, most_triangles),
                           map.name + ": triangles", 512);
    }
    return html;
}

} // namespace pertev
