#include "lab/lab_tables.h"

#include <algorithm>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/byte_units.h"
#include "lab/heat_map.h"
#include "lab/text_table.h"

namespace pertev {
namespace {

const char* family_of(TraversalKind traversal) {
    using enum TraversalKind;
    switch (traversal) {
    case IfIf:
    case WhileWhile:
    case Speculative:
    case Octants:
        return "binary, with a stack";
    case RestartTrail:
    case ShortStack:
    case ParentLinks:
    case SkipLinks:
        return "binary, stackless";
    case Packet:
        return "packets";
    case Wide4:
    case Wide8:
    case Wide8Simd:
    case Compressed:
        return "wide and compressed";
    case Kd:
    case Octree:
        return "kd-tree and octree";
    case BruteForce:
        break;
    }
    return "brute force";
}

/// Returns null if the combination was never reached or its structure could not be built.
const StructureFigures* structure_of(const LabReport& report, const CombinationFigures& c) {
    if (!c.structure || *c.structure >= report.structures.size()) return nullptr;
    const StructureFigures& s = report.structures[*c.structure];
    return s.failed.empty() ? &s : nullptr;
}

Fields report_fields(const LabReport& r) {
    return {{"scene", "scene", r.scene},
            {"device", "device", r.device},
            {"commit", "", r.commit},
            {"threads", "", r.threads},
            {"scene_triangles", "triangles", r.triangles},
            {"width", "width", r.width},
            {"height", "height", r.height},
            {"runs", "runs", r.runs},
            {"warm_ups", "", r.warm_ups},
            {"interrupted", "", r.interrupted}};
}

Fields structure_fields(const LabReport& report, const StructureFigures* s) {
    const auto of = [s](auto member) { return s != nullptr ? ResultCell(s->*member) : ResultCell(); };
    return {{"nodes", "nodes", of(&StructureFigures::nodes)},
            {"leaf_triangles", "triangles", of(&StructureFigures::triangles)},
            {"build_seconds", "build", of(&StructureFigures::build_s), "s", "{:.3f}"},
            {"sah_cost", "SAH cost", of(&StructureFigures::sah_cost), "", "{:.2f}"},
            {"depth", "depth", of(&StructureFigures::depth)},
            {"bytes", "", of(&StructureFigures::bytes)},
            {"mebibytes", "memory", s != nullptr ? ResultCell(mebibytes(s->bytes)) : ResultCell(), "MiB", "{:.1f}"},
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
    Fields fields = {{"combination", "combination", c.name},
                     {"structure", "structure", name_of(c.combination.structure)},
                     {"walk", "traversal", name_of(c.combination.traversal)},
                     {"family", "", family_of(c.combination.traversal)},
                     {"rta", "RTA", name_of_rta(o)},
                     {"near_first", "near first", o.near_first},
                     {"tests", "tests", name_of(o.tests)},
                     {"distribution", "distribution", name_of(c.combination.distribution)},
                     {"refused", "not run because", if_not_empty(c.refused)},
                     {"wrong", "wrong", c.wrong},
                     {"registers", "registers", of_kernel ? ResultCell(c.registers) : ResultCell()},
                     {"local_bytes", "local bytes", of_kernel ? ResultCell(c.local_bytes) : ResultCell()},
                     {"occupancy", "occupancy", of_kernel ? ResultCell(c.occupancy) : ResultCell(), "", "{:.2f}"}};
    for (const ResultField& field : structure_fields(report, structure_of(report, c))) fields.push_back(field);
    const Fields measured = {
        {"set", "rays of", set != nullptr ? ResultCell(set->name) : ResultCell()},
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
         frame_s ? ResultCell(static_cast<double>(frame_rays(report, set->depth)) / *frame_s * 1e-6) : ResultCell()},
        {"nodes_per_ray", "nodes a ray", of(&RunFigures::nodes), "", "{:.1f}"},
        {"triangles_per_ray", "triangles a ray", of(&RunFigures::triangles), "", "{:.1f}"},
        {"node_lanes", "lanes, nodes", of(&RunFigures::node_lanes), "", "{:.1f}"},
        {"triangle_lanes", "lanes, triangles", of(&RunFigures::triangle_lanes), "", "{:.1f}"},
        {"node_sectors", "sectors, nodes", of(&RunFigures::node_sectors), "", "{:.1f}"},
        {"triangle_sectors", "sectors, triangles", of(&RunFigures::triangle_sectors), "", "{:.1f}"},
        {"different_rays", "rays that differ", of(&RunFigures::different)},
        {"is_copy", "is copy", of(&RunFigures::is_copy)},
        {"price_of_exactness", "price of exactness",
         run != nullptr ? ResultCell(price_of_exactness(report, c, run->set)) : ResultCell(), "", "{:.3f}"}};
    fields.insert(fields.end(), measured.begin(), measured.end());
    return fields;
}

ResultTable sets_of(const LabReport& report) {
    ResultTable table = {"sets", "Sets of rays"};
    for (const SetFigures& s : report.sets) {
        table.add({{"name", "set", s.name},
                   {"any_hit", "any hit", s.any_hit},
                   {"depth", "depth", s.depth > 0 ? ResultCell(s.depth) : ResultCell()},
                   {"rays", "rays", s.rays},
                   {"hit_share", "share of hits", s.hit_share, "", "{:.3f}"},
                   {"brute_force_rays", "held against brute force", s.brute_force_rays, "rays"}});
    }
    return table;
}

ResultTable structures_of(const LabReport& report) {
    ResultTable table = {"structures", "Structures"};
    for (const StructureFigures& s : report.structures) {
        Fields row = {{"name", "structure", s.name}, {"failed", "", if_not_empty(s.failed)}};
        for (const ResultField& field : structure_fields(report, s.failed.empty() ? &s : nullptr)) row.push_back(field);
        table.add(row);
    }
    return table;
}

ResultTable runs_of(const LabReport& report) {
    ResultTable table = {"runs", "All figures"};
    for (const CombinationFigures& c : report.combinations) {
        if (c.runs.empty()) table.add(run_fields(report, c, nullptr));
        for (const RunFigures& run : c.runs) table.add(run_fields(report, c, &run));
    }
    return table;
}

std::string wrong_lines(const LabReport& report) {
    std::string lines;
    for (const CombinationFigures& c : report.combinations) {
        const bool says_so = c.refused.starts_with("WRONG: ");
        if (c.wrong) lines += fmt::format("WRONG {}: {}\n", c.name, says_so ? c.refused.substr(7) : c.refused);
    }
    return lines;
}

/// Combinations with figures, the fastest first. Completely measured ones come before interrupted ones.
std::vector<const CombinationFigures*> in_order(const LabReport& report) {
    std::vector<const CombinationFigures*> order;
    for (const CombinationFigures& c : report.combinations) {
        if (!c.runs.empty() && !c.wrong) order.push_back(&c);
    }
    const auto key = [&](const CombinationFigures* c) {
        double seconds = 0;
        for (const RunFigures& run : c->runs) seconds += run.median_s;
        return std::pair(report.sets.size() - c->runs.size(), seconds);
    };
    std::ranges::stable_sort(order, {}, key);
    return order;
}

/// Returns "12.34 [11.90, 12.51] (10.1 + 2.3)", or the part of it that was measured.
std::string speed_of(const LabReport& report, const RunFigures& run) {
    std::string text;
    if (run.median_s > 0) {
        text = fixed_text(mrays(report, run), 2);
        if (report.runs > 1) {
            text += fmt::format(" [{}, {}]", fixed_text(mrays(report, run, run.largest_s), 2),
                                fixed_text(mrays(report, run, run.min_s), 2));
        }
    }
    if (run.nodes && run.triangles) {
        text += fmt::format("{}({:.1f} + {:.1f})", text.empty() ? "" : " ", *run.nodes, *run.triangles);
    }
    return text.empty() ? "right" : text; // its hits match the proven traversal, and nothing else was measured
}

} // namespace

Measurement measurement_of(const LabReport& report, Measurement m) {
    m.title = "Traversal laboratory: " + report.scene;
    m.interrupted = report.interrupted;
    ResultTable scene = {"scene", "Scene"};
    Fields fields = report_fields(report);
    fields.insert(fields.end(), {{"instances", "instances", report.instances},
                                 {"camera", "camera", report.camera},
                                 {"first_depth", "first depth", report.first_depth},
                                 {"last_depth", "last depth", largest_depth(report)}});
    scene.add(fields);
    m.tables = {scene, sets_of(report), structures_of(report), runs_of(report)};
    for (const CombinationFigures& c : report.combinations) {
        if (c.wrong) m.notes.push_back(fmt::format("WRONG {}: {}", c.name, c.refused));
    }
    m.notes.insert(m.notes.end(), report.notes.begin(), report.notes.end());
    for (const Refusal& refusal : refusals_by_reason(report.combinations)) {
        m.notes.push_back(fmt::format("Not run: {}: {}", refusal.reason, fmt::join(refusal.names, ", ")));
    }
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
    if (report.heat_maps.size() < report.heat_map_names.size()) {
        m.notes.push_back(
            fmt::format("Heat maps are of the {} combinations that were fastest at camera rays, of {}; all "
                        "are PNG files beside this report, each on a scale of its own.",
                        report.heat_maps.size(), report.heat_map_names.size()));
    }
    return m;
}

std::string csv_of(const LabReport& report) { return csv_of(runs_of(report), report_fields(report)); }

std::string text_of(const LabReport& report) {
    std::string text = wrong_lines(report);
    if (!text.empty()) text += '\n';
    ResultTable structures = structures_of(report);
    std::string failed;
    for (const StructureFigures& s : report.structures) {
        if (!s.failed.empty()) failed += fmt::format("{}: {}\n", s.name, s.failed);
    }
    std::erase_if(structures.rows, [](const std::vector<ResultCell>& row) { return row[1].is_there(); });
    if (!structures.rows.empty()) text += text_of(structures);
    text += failed;
    const std::vector<const CombinationFigures*> order = in_order(report);
    std::vector<std::vector<std::string>> speeds = {{"combination"}}, frames = {{"combination"}};
    for (const SetFigures& set : report.sets) speeds[0].push_back(set.name);
    for (int depth = report.first_depth; depth <= largest_depth(report); ++depth) {
        frames[0].push_back(fmt::format("depth {}", depth));
    }
    ResultTable warps;
    for (const CombinationFigures* c : order) {
        speeds.push_back({c->name});
        for (uint32_t set = 0; set < report.sets.size(); ++set) {
            const RunFigures* run = find_run(*c, set);
            speeds.back().push_back(run != nullptr ? speed_of(report, *run) : "");
        }
        if (frame_seconds(report, *c, report.first_depth)) frames.push_back({c->name});
        for (int depth = report.first_depth; frames.back()[0] == c->name && depth <= largest_depth(report); ++depth) {
            const std::optional<double> seconds = frame_seconds(report, *c, depth);
            frames.back().push_back(seconds ? fixed_text(1 / *seconds, 2) : "");
        }
        for (const RunFigures& run : c->runs) {
            if (c->registers || run.node_lanes || run.node_sectors) warps.add(run_fields(report, *c, &run));
        }
    }
    if (!order.empty()) {
        text += fmt::format("\nmillion rays a second on {} [slowest, fastest run] (nodes + triangles tested a ray)\n{}",
                            report.device, align_columns(speeds));
    }
    if (frames.size() > 1) text += "\nframes a second by depth of paths\n" + align_columns(frames);
    if (!warps.rows.empty()) {
        text += "\nlive lanes of 32 and 32-byte sectors per load; registers and the occupancy that they allow\n" +
                text_of(warps, {"combination", "set", "node_lanes", "triangle_lanes", "node_sectors",
                                "triangle_sectors", "registers", "occupancy"});
    }
    if (!report.notes.empty()) text += '\n';
    for (const std::string& note : report.notes) text += note + '\n';
    if (report.interrupted) text += "\ninterrupted: this is what had been measured\n";
    return text;
}

} // namespace pertev
