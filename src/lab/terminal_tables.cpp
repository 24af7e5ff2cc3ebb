// text_of of write_tables.h: the report on a terminal.

#include <algorithm>

#include <fmt/format.h>

#include "base/byte_units.h"
#include "lab/text_table.h"
#include "lab/write_tables.h"

namespace pertev {
namespace {

using Rows = std::vector<std::vector<std::string>>;

std::string wrong_lines(const LabReport& report) {
    std::string lines;
    for (const CombinationFigures& c : report.combinations) {
        if (!c.wrong) continue;
        const bool says_so = c.refused.starts_with("WRONG: ");
        lines += fmt::format("WRONG {}: {}\n", c.name, says_so ? c.refused.substr(7) : c.refused);
    }
    return lines.empty() ? lines : lines + '\n';
}

std::string structures_of(const LabReport& report) {
    Rows rows = {{"structure", "build s", "nodes", "triangles", "MiB", "SAH cost", "depth"}};
    std::string failed;
    for (const StructureFigures& s : report.structures) {
        if (!s.failed.empty()) {
            failed += fmt::format("{}: {}\n", s.name, s.failed);
            continue;
        }
        rows.push_back({s.name, fixed_text(s.build_s, 3), fmt::format("{}", s.nodes), fmt::format("{}", s.triangles),
                        fmt::format("{:.1f}", mebibytes(s.bytes)), s.sah_cost ? fmt::format("{:.2f}", *s.sah_cost) : "",
                        s.depth ? fmt::format("{}", *s.depth) : ""});
    }
    return (rows.size() > 1 ? align_columns(rows) : "") + failed;
}

/// Those with figures, the fastest first.
std::vector<const CombinationFigures*> in_order(const LabReport& report) {
    std::vector<const CombinationFigures*> order;
    for (const CombinationFigures& c : report.combinations) {
        if (!c.runs.empty() && !c.wrong) order.push_back(&c);
    }
    const auto total_s = [](const CombinationFigures* c) {
        double seconds = 0;
        for (const RunFigures& run : c->runs) seconds += run.median_s;
        return seconds;
    };
    // Complete ones first: one that was interrupted has spent less time for less work.
    std::ranges::stable_sort(order, [&](const CombinationFigures* a, const CombinationFigures* b) {
        return a->runs.size() != b->runs.size() ? a->runs.size() > b->runs.size() : total_s(a) < total_s(b);
    });
    return order;
}

/// "12.34 [11.90, 12.51] (10.1 + 2.3)", as much of it as was measured.
std::string speed_of(const LabReport& report, const RunFigures& run) {
    std::string text;
    if (run.median_s > 0) {
        text = fixed_text(mrays(report, run), 2);
        if (report.runs > 1) {
            text += fmt::format(" [{}, {}]", fixed_text(mrays(report, run, run.largest_s), 2),
                                fixed_text(mrays(report, run, run.least_s), 2));
        }
    }
    if (run.nodes && run.triangles) {
        text += fmt::format("{}({:.1f} + {:.1f})", text.empty() ? "" : " ", *run.nodes, *run.triangles);
    }
    return text.empty() ? "right"
                        : text; // the hits are those of the proven walk (lab/run_lab.h), and nothing else was asked for
}

std::string speeds_of(const LabReport& report, const std::vector<const CombinationFigures*>& order) {
    Rows rows = {{"combination"}};
    for (const SetFigures& set : report.sets) rows[0].push_back(set.name);
    for (const CombinationFigures* c : order) {
        rows.push_back({c->name});
        for (uint32_t set = 0; set < report.sets.size(); ++set) {
            const RunFigures* run = find_run(*c, set);
            rows.back().push_back(run != nullptr ? speed_of(report, *run) : "");
        }
    }
    return fmt::format("\nmillion rays a second on {} [slowest, fastest run] (nodes + triangles tested a ray)\n{}",
                       report.device, align_columns(rows));
}

std::string frames_of(const LabReport& report, const std::vector<const CombinationFigures*>& order) {
    Rows rows = {{"combination"}};
    for (int depth = report.first_depth; depth <= largest_depth(report); ++depth) {
        rows[0].push_back(fmt::format("depth {}", depth));
    }
    for (const CombinationFigures* c : order) {
        if (!frame_seconds(report, *c, report.first_depth)) continue;
        rows.push_back({c->name});
        for (int depth = report.first_depth; depth <= largest_depth(report); ++depth) {
            const std::optional<double> seconds = frame_seconds(report, *c, depth);
            rows.back().push_back(seconds ? fixed_text(1 / *seconds, 2) : "");
        }
    }
    return rows.size() > 1 ? "\nframes a second by depth of paths\n" + align_columns(rows) : "";
}

std::string pair_of(const std::optional<double>& a, const std::optional<double>& b) {
    return a || b ? fmt::format("{} / {}", a ? fmt::format("{:.1f}", *a) : "", b ? fmt::format("{:.1f}", *b) : "") : "";
}

/// Of the sets that any combination has lanes of.
std::string warps_of(const LabReport& report, const std::vector<const CombinationFigures*>& order) {
    std::vector<uint32_t> sets;
    for (uint32_t set = 0; set < report.sets.size(); ++set) {
        const bool any = std::ranges::any_of(order, [set](const CombinationFigures* c) {
            const RunFigures* run = find_run(*c, set);
            return run != nullptr && (run->node_lanes || run->node_sectors);
        });
        if (any) sets.push_back(set);
    }
    const bool kernels =
        std::ranges::any_of(order, [](const CombinationFigures* c) { return c->registers.has_value(); });
    if (sets.empty() && !kernels) return {};
    Rows rows = {{"combination"}};
    for (const uint32_t set : sets) {
        rows[0].push_back(report.sets[set].name + " lanes");
        rows[0].emplace_back("sectors");
    }
    if (kernels) rows[0].insert(rows[0].end(), {"registers", "occupancy"});
    for (const CombinationFigures* c : order) {
        rows.push_back({c->name});
        for (const uint32_t set : sets) {
            const RunFigures* run = find_run(*c, set);
            rows.back().push_back(run != nullptr ? pair_of(run->node_lanes, run->triangle_lanes) : "");
            rows.back().push_back(run != nullptr ? pair_of(run->node_sectors, run->triangle_sectors) : "");
        }
        if (!kernels) continue;
        rows.back().push_back(c->registers ? fmt::format("{}", *c->registers) : "");
        rows.back().push_back(c->occupancy ? fmt::format("{:.0f}%", 100 * *c->occupancy) : "");
    }
    return "\nlive lanes of 32, and 32-byte sectors a load, at nodes / triangles; registers of the closest-hit kernel "
           "and the occupancy they allow\n" +
           align_columns(rows);
}

} // namespace

std::string text_of(const LabReport& report) {
    const std::vector<const CombinationFigures*> order = in_order(report);
    std::string text = wrong_lines(report) + structures_of(report);
    if (!order.empty()) text += speeds_of(report, order) + frames_of(report, order) + warps_of(report, order);
    if (!report.notes.empty()) text += '\n';
    for (const std::string& note : report.notes) text += note + '\n';
    if (report.interrupted) text += "\ninterrupted: this is what had been measured\n";
    return text;
}

} // namespace pertev
