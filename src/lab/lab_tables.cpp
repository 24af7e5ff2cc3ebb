#include "lab/lab_tables.h"

#include <algorithm>
#include <functional>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "lab/heat_map.h"

namespace pertev {
namespace {

/// Returns the figures of a combination's structure; null if the combination was never reached or its structure could
/// not be built.
const StructureFigures* structure_of(const LabReport& report, const CombinationFigures& c) {
    if (!c.structure || *c.structure >= report.structures.size()) return nullptr;
    const StructureFigures& s = report.structures[*c.structure];
    return s.failed.empty() ? &s : nullptr;
}

Fields structure_fields(const LabReport& report, const StructureFigures* s) {
    const auto of = [s](auto member) { return s != nullptr ? ResultCell(s->*member) : ResultCell(); };
    return {{"nodes", "nodes", of(&StructureFigures::nodes)},
            {"leaf_triangles", "triangles", of(&StructureFigures::triangles)},
            {"build_seconds", "build", of(&StructureFigures::build_s), "s", "{:.3f}"},
            {"sah_cost", "SAH cost", of(&StructureFigures::sah_cost), "", "{:.2f}"},
            {"depth", "depth", of(&StructureFigures::depth)},
            {"bytes", "bytes", of(&StructureFigures::bytes)},
            {"bytes_per_triangle", "",
             s != nullptr ? ResultCell(static_cast<double>(s->bytes) /
                                       static_cast<double>(std::max<uint64_t>(report.triangles, 1)))
                          : ResultCell()}};
}

/// One row of the table "runs"; `run` is null for a combination without figures.
Fields run_fields(const LabReport& report, const CombinationFigures& c, const RunFigures* run) {
    const TraversalOptions& o = c.combination.options;
    const SetFigures* set = run != nullptr ? &report.sets[run->set] : nullptr;
    const bool of_kernel = set == nullptr || !set->any_hit;
    const std::optional<double> frame_s =
        set != nullptr && set->depth > 0 ? frame_seconds(report, c, set->depth) : std::nullopt;
    const auto of = [run](auto member) { return run != nullptr ? ResultCell(run->*member) : ResultCell(); };
    const auto time = [&](double RunFigures::*member) {
        return run != nullptr ? if_timed(run->*member) : std::nullopt;
    };
    const auto rate = [&](double RunFigures::*member) {
        return run != nullptr ? if_timed(mrays(report, *run, run->*member)) : std::nullopt;
    };
    return Fields{{"combination", "combination", c.name},
                  {"structure", "structure", name_of(c.combination.structure)},
                  {"traversal", "traversal", name_of(c.combination.traversal)},
                  {"rta", "RTA", name_of_rta(o)},
                  {"near_first", "near first", o.near_first},
                  {"tests", "tests", name_of(o.tests)},
                  {"distribution", "distribution", name_of(c.combination.distribution)},
                  {"refused", "not run because", if_not_empty(c.refused)},
                  {"wrong", "wrong", c.wrong},
                  {"registers", "registers", of_kernel ? ResultCell(c.registers) : ResultCell()},
                  {"local_bytes", "local bytes", of_kernel ? ResultCell(c.local_bytes) : ResultCell()},
                  {"occupancy", "occupancy", of_kernel ? ResultCell(c.occupancy) : ResultCell(), "", "{:.2f}"}} +
           structure_fields(report, structure_of(report, c)) +
           Fields{{"set", "rays of", set != nullptr ? ResultCell(set->name) : ResultCell()},
                  {"rays", "rays", set != nullptr ? ResultCell(set->rays) : ResultCell()},
                  {"hit_share", "", set != nullptr ? ResultCell(set->hit_share) : ResultCell()},
                  {"rays_per_second", "",
                   rate(&RunFigures::median_s) ? ResultCell(*rate(&RunFigures::median_s) * 1e6) : ResultCell()},
                  {"mrays", "Mrays/s", rate(&RunFigures::median_s), "", "{:.2f}"},
                  {"mrays_slowest", "slowest", rate(&RunFigures::largest_s), "", "{:.2f}"},
                  {"mrays_fastest", "fastest", rate(&RunFigures::min_s), "", "{:.2f}"},
                  {"median_seconds", "", time(&RunFigures::median_s)},
                  {"least_seconds", "", time(&RunFigures::min_s)},
                  {"greatest_seconds", "", time(&RunFigures::largest_s)},
                  {"frame_depth", "depth", frame_s ? ResultCell(set->depth) : ResultCell()},
                  {"frames_per_second", "frames/s", frame_s ? ResultCell(1 / *frame_s) : ResultCell(), "", "{:.2f}"},
                  {"seconds_per_frame", "frame", frame_s, "s", "{:.5f}"},
                  {"frame_mrays", "",
                   frame_s ? ResultCell(static_cast<double>(frame_rays(report, set->depth)) / *frame_s * 1e-6)
                           : ResultCell()},
                  {"nodes_per_ray", "nodes per ray", of(&RunFigures::nodes), "", "{:.1f}"},
                  {"triangles_per_ray", "triangles per ray", of(&RunFigures::triangles), "", "{:.1f}"},
                  {"node_lanes", "lanes, nodes", of(&RunFigures::node_lanes), "", "{:.1f}"},
                  {"triangle_lanes", "lanes, triangles", of(&RunFigures::triangle_lanes), "", "{:.1f}"},
                  {"node_sectors", "sectors, nodes", of(&RunFigures::node_sectors), "", "{:.1f}"},
                  {"triangle_sectors", "sectors, triangles", of(&RunFigures::triangle_sectors), "", "{:.1f}"},
                  {"different_rays", "differing rays", of(&RunFigures::different)},
                  {"is_copy", "is copy", of(&RunFigures::is_copy)}};
}

ResultTable sets_of(const LabReport& report) {
    ResultTable table = {"sets", "Ray sets"};
    for (const SetFigures& s : report.sets) {
        table.add({{"name", "set", s.name},
                   {"any_hit", "any hit", s.any_hit},
                   {"depth", "depth", s.depth > 0 ? ResultCell(s.depth) : ResultCell()},
                   {"rays", "rays", s.rays},
                   {"hit_share", "share of hits", s.hit_share, "", "{:.3f}"},
                   {"brute_force_rays", "compared with brute force", s.brute_force_rays, "rays"}});
    }
    return table;
}

ResultTable structures_of(const LabReport& report) {
    ResultTable table = {"structures", "Structures"};
    for (const StructureFigures& s : report.structures) {
        table.add(Fields{{"name", "structure", s.name}, {"failed", "", if_not_empty(s.failed)}} +
                  structure_fields(report, s.failed.empty() ? &s : nullptr));
    }
    return table;
}

ResultTable runs_of(const LabReport& report) {
    ResultTable table = {"runs", "All runs"};
    for (const CombinationFigures& c : report.combinations) {
        if (c.runs.empty()) table.add(run_fields(report, c, nullptr));
        for (const RunFigures& run : c.runs) table.add(run_fields(report, c, &run));
    }
    return table;
}

/// Returns notes on combinations that are wrong, missing results, and combinations that were not run, with the reasons.
std::vector<std::string> notes_of(const LabReport& report) {
    std::vector<std::string> notes;
    for (const CombinationFigures& c : report.combinations) {
        if (c.wrong) notes.push_back(fmt::format("WRONG {}: {}", c.name, c.refused));
    }
    for (const StructureFigures& s : report.structures) {
        if (!s.failed.empty()) notes.push_back(fmt::format("{}: {}", s.name, s.failed));
    }
    notes.insert(notes.end(), report.notes.begin(), report.notes.end());
    for (const Refusal& refusal : refusals_by_reason(report.combinations)) {
        notes.push_back(fmt::format("Not run: {}: {}", refusal.reason, fmt::join(refusal.names, ", ")));
    }
    return notes;
}

} // namespace

Measurement measurement_of(const LabReport& report, Measurement m) {
    m.title = "Traversal laboratory: " + report.scene;
    m.interrupted = report.interrupted;
    ResultTable scene = {"scene", "Scene"};
    scene.add({{"scene", "scene", report.scene},
               {"scene_triangles", "triangles", report.triangles},
               {"instances", "instances", report.instances},
               {"camera", "camera", report.camera},
               {"width", "width", report.width},
               {"height", "height", report.height},
               {"first_depth", "first depth", report.first_depth},
               {"last_depth", "last depth", largest_depth(report)},
               {"runs", "runs", report.runs},
               {"warm_ups", "warm-ups", report.warm_ups},
               {"interrupted", "interrupted", report.interrupted}});
    m.tables = {scene, sets_of(report), structures_of(report), runs_of(report)};
    m.notes = notes_of(report);
    m.kind = "lab";
    uint32_t most[2] = {1, 1}; // all pictures share one scale, so they can be compared
    for (const HeatMap& map : report.heat_maps) {
        most[0] = std::max(most[0], scale_end(map.nodes)), most[1] = std::max(most[1], scale_end(map.triangles));
    }
    for (const HeatMap& map : report.heat_maps) {
        const auto add = [&](const char* what, const std::vector<uint32_t>& counts, uint32_t end) {
            m.pictures.push_back({fmt::format("Tests per pixel, camera rays: {}", what), map.name,
                                  fmt::format("dark is few, pale yellow is {} or more; one scale for all", end),
                                  draw_heat_map(counts, map.width, map.height, end)});
        };
        add("nodes", map.nodes, most[0]);
        add("triangles", map.triangles, most[1]);
    }
    return m;
}

std::string text_of(const LabReport& report) {
    const ResultTable runs = runs_of(report);
    ResultTable rates = pivot(runs, "combination", "set", "mrays");
    std::ranges::stable_sort(rates.rows, std::greater{}, [](const auto& row) { return row[1].number().value_or(0); });
    std::string text = text_of(structures_of(report));
    text += fmt::format("\nmillion rays per second on {}\n{}", report.device, text_of(rates));
    const ResultTable frames = pivot(runs, "combination", "frame_depth", "frames_per_second");
    if (!frames.rows.empty()) text += "\nframes per second by depth of paths\n" + text_of(frames) + '\n';
    for (const std::string& note : notes_of(report)) text += note + '\n';
    if (report.interrupted) text += "interrupted: the results are incomplete\n";
    return text;
}

} // namespace pertev
