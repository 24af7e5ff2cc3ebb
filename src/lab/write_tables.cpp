#include "lab/write_tables.h"

#include <fmt/format.h>

#include "base/json_text.h"
#include "lab/csv_line.h"

namespace pertev {
namespace {

using Cells = CsvCells;

template <class T>
std::string number(const T& value) {
    return fmt::format("{}", value);
}
std::string number(bool value) { return value ? "1" : "0"; }

template <class T>
std::string optional(const std::optional<T>& value, const char* format) {
    return value ? fmt::format(fmt::runtime(format), *value) : "";
}
/// Seconds, and what follows from them; no time is 0.
std::string timed(double value, const char* format) {
    return value > 0 ? fmt::format(fmt::runtime(format), value) : "";
}

/// Null where it never came to its turn or could not be built.
const StructureFigures* structure_of(const LabReport& report, const CombinationFigures& c) {
    if (!c.structure || *c.structure >= report.structures.size()) return nullptr;
    const StructureFigures& s = report.structures[*c.structure];
    return s.failed.empty() ? &s : nullptr;
}

// Each part has its head beside its cells, in one order.

Cells report_head() {
    return {"scene", "device", "commit", "threads",  "scene_triangles",
            "width", "height", "runs",   "warm_ups", "interrupted"};
}
Cells report_cells(const LabReport& r) {
    return {r.scene,         r.device,         r.commit,       number(r.threads),  number(r.triangles),
            number(r.width), number(r.height), number(r.runs), number(r.warm_ups), number(r.interrupted)};
}

Cells combination_head() {
    return {"combination", "structure", "walk", "rta", "near_first", "tests", "distribution", "refused", "wrong"};
}
Cells combination_cells(const CombinationFigures& c) {
    const WalkOptions& o = c.combination.options;
    return {c.name,
            std::string(name_of(c.combination.structure)),
            std::string(name_of(c.combination.walk)),
            name_of_rta(o),
            number(o.near_first),
            std::string(name_of(o.tests)),
            std::string(name_of(c.combination.distribution)),
            c.refused,
            number(c.wrong)};
}

Cells kernel_head() { return {"registers", "local_bytes", "occupancy"}; }
Cells kernel_cells(const CombinationFigures& c) {
    return {optional(c.registers, "{}"), optional(c.local_bytes, "{}"), optional(c.occupancy, "{:.3f}")};
}

Cells structure_head() { return {"nodes", "leaf_triangles", "build_seconds", "sah_cost", "depth", "bytes"}; }
Cells structure_cells(const StructureFigures& s) {
    return {
        number(s.nodes),         number(s.triangles), fmt::format("{:.6g}", s.build_s), optional(s.sah_cost, "{:.3f}"),
        optional(s.depth, "{}"), number(s.bytes)};
}

Cells run_head() {
    return {"set",
            "rays",
            "hit_share",
            "rays_per_second",
            "median_seconds",
            "least_seconds",
            "greatest_seconds",
            "frame_depth",
            "frames_per_second",
            "seconds_per_frame",
            "nodes_per_ray",
            "triangles_per_ray",
            "node_lanes",
            "triangle_lanes",
            "node_sectors",
            "triangle_sectors",
            "different_rays",
            "is_copy",
            "price_of_exactness"};
}
Cells run_cells(const LabReport& report, const CombinationFigures& c, const RunFigures& run) {
    const SetFigures& set = report.sets[run.set];
    const std::optional<double> frame_s = set.depth > 0 ? frame_seconds(report, c, set.depth) : std::nullopt;
    return {set.name,
            number(set.rays),
            fmt::format("{:.5f}", set.hit_share),
            timed(mrays(report, run) * 1e6, "{:.0f}"),
            timed(run.median_s, "{:.9f}"),
            timed(run.least_s, "{:.9f}"),
            timed(run.largest_s, "{:.9f}"),
            frame_s ? number(set.depth) : "",
            frame_s ? fmt::format("{:.6g}", 1 / *frame_s) : "",
            optional(frame_s, "{:.9f}"),
            optional(run.nodes, "{:.3f}"),
            optional(run.triangles, "{:.3f}"),
            optional(run.node_lanes, "{:.2f}"),
            optional(run.triangle_lanes, "{:.2f}"),
            optional(run.node_sectors, "{:.2f}"),
            optional(run.triangle_sectors, "{:.2f}"),
            number(run.different),
            number(run.is_copy),
            optional(price_of_exactness(report, c, run.set), "{:.4f}")};
}

void append(Cells& to, const Cells& cells) { to.insert(to.end(), cells.begin(), cells.end()); }

template <class T>
std::string json_optional(const std::optional<T>& value) {
    return value ? json_number(static_cast<double>(*value)) : "null";
}
std::string json_timed(double value) { return value > 0 ? json_number(value) : "null"; }

std::string json_of(const StructureFigures& s) {
    if (!s.failed.empty()) {
        return fmt::format(
            R"({{"name":{},"failed":{},"build_seconds":null,"nodes":null,"triangles":null,"bytes":null,"sah_cost":null,"depth":null}})",
            json_string(s.name), json_string(s.failed));
    }
    return fmt::format(
        R"({{"name":{},"failed":null,"build_seconds":{},"nodes":{},"triangles":{},"bytes":{},"sah_cost":{},"depth":{}}})",
        json_string(s.name), json_number(s.build_s), s.nodes, s.triangles, s.bytes, json_optional(s.sah_cost),
        json_optional(s.depth));
}

std::string json_of(const LabReport& report, const CombinationFigures& c, const RunFigures& run) {
    return fmt::format(
        R"({{"set":{},"rays_per_second":{},"median_seconds":{},"least_seconds":{},"greatest_seconds":{},"nodes_per_ray":{},"triangles_per_ray":{},"node_lanes":{},"triangle_lanes":{},"node_sectors":{},"triangle_sectors":{},"different":{},"is_copy":{},"price_of_exactness":{}}})",
        json_string(report.sets[run.set].name), json_timed(mrays(report, run) * 1e6), json_timed(run.median_s),
        json_timed(run.least_s), json_timed(run.largest_s), json_optional(run.nodes), json_optional(run.triangles),
        json_optional(run.node_lanes), json_optional(run.triangle_lanes), json_optional(run.node_sectors),
        json_optional(run.triangle_sectors), run.different, run.is_copy,
        json_optional(price_of_exactness(report, c, run.set)));
}

std::string json_of(const LabReport& report, const CombinationFigures& c) {
    std::string runs, frames;
    for (const RunFigures& run : c.runs) runs += (runs.empty() ? "" : ",") + json_of(report, c, run);
    for (int depth = report.first_depth; depth <= largest_depth(report); ++depth) {
        frames += (frames.empty() ? "" : ",") + json_optional(frame_seconds(report, c, depth));
    }
    const StructureFigures* structure = structure_of(report, c);
    return fmt::format(
        R"({{"name":{},"structure":{},"structure_kind":"{}","walk":"{}","rta":"{}","near_first":{},"tests":"{}","distribution":"{}","refused":{},"wrong":{},"registers":{},"local_bytes":{},"occupancy":{},"frame_seconds":[{}],"runs":[{}]}})",
        json_string(c.name), structure != nullptr ? json_string(structure->name) : "null",
        name_of(c.combination.structure), name_of(c.combination.walk), name_of_rta(c.combination.options),
        c.combination.options.near_first, name_of(c.combination.options.tests), name_of(c.combination.distribution),
        c.refused.empty() ? "null" : json_string(c.refused), c.wrong, json_optional(c.registers),
        json_optional(c.local_bytes), json_optional(c.occupancy), frames, runs);
}

} // namespace

std::string csv_of(const LabReport& report) {
    Cells head = report_head();
    for (const Cells& part : {combination_head(), kernel_head(), structure_head(), run_head()}) append(head, part);
    std::string csv = csv_line(head);
    for (const CombinationFigures& c : report.combinations) {
        const StructureFigures* structure = structure_of(report, c);
        const auto line = [&](const RunFigures* run) {
            const bool of_kernel = run == nullptr || !report.sets[run->set].any_hit;
            Cells cells = report_cells(report);
            append(cells, combination_cells(c));
            append(cells, of_kernel ? kernel_cells(c) : Cells(kernel_head().size()));
            append(cells, structure != nullptr ? structure_cells(*structure) : Cells(structure_head().size()));
            append(cells, run != nullptr ? run_cells(report, c, *run) : Cells(run_head().size()));
            return csv_line(cells);
        };
        if (c.runs.empty()) csv += line(nullptr);
        for (const RunFigures& run : c.runs) csv += line(&run);
    }
    return csv;
}

std::string json_of(const LabReport& report) {
    std::string sets, structures, combinations, notes;
    for (const SetFigures& set : report.sets) {
        sets += fmt::format(R"({}{{"name":{},"any_hit":{},"depth":{},"rays":{},"hit_share":{},"brute_force_rays":{}}})",
                            sets.empty() ? "" : ",", json_string(set.name), set.any_hit, set.depth, set.rays,
                            json_number(set.hit_share), set.brute_force_rays);
    }
    for (const StructureFigures& s : report.structures) structures += (structures.empty() ? "" : ",") + json_of(s);
    for (const CombinationFigures& c : report.combinations) {
        combinations += (combinations.empty() ? "" : ",") + json_of(report, c);
    }
    for (const std::string& note : report.notes) notes += (notes.empty() ? "" : ",") + json_string(note);
    return fmt::format(
        R"({{"event":"lab","scene":{},"device":{},"commit":{},"threads":{},"camera":{},"triangles":{},"instances":{},"width":{},"height":{},"first_depth":{},"runs":{},"warm_ups":{},"interrupted":{},"notes":[{}],"sets":[{}],"structures":[{}],"combinations":[{}]}})",
        json_string(report.scene), json_string(report.device), json_string(report.commit), report.threads,
        json_string(report.camera), report.triangles, report.instances, report.width, report.height, report.first_depth,
        report.runs, report.warm_ups, report.interrupted, notes, sets, structures, combinations);
}

} // namespace pertev
