#include "lab/html_tables.h"

#include <algorithm>
#include <functional>
#include <utility>

#include <fmt/format.h>

#include "base/byte_units.h"
#include "lab/svg_plot.h"
#include "lab/text_table.h"

namespace pertev {
namespace {

constexpr const char* kNodeNote =
    "<p>What a node is differs: a test of a binary node is of its children's two boxes, that of parent-links and "
    "skip-links of one box a step, of wide and compressed nodes four or eight boxes, of a kd-tree one plane, of an "
    "octree three planes. A ray of a packet counts the nodes that it takes part in.</p>\n";
constexpr const char* kWarpNote =
    "<p>Lanes: live ones of 32 at a test. Sectors: of 32 bytes, what a warp's load of 16 bytes a lane touches, from 1 "
    "(all lanes at one place) over 16 (neighbours, perfect) to 32. Registers and local memory are those of the "
    "closest-hit kernel, a thread. Occupancy is what its registers allow, not measured.</p>\n";

std::string cell(std::string_view text) { return "<td>" + html_text(text) + "</td>"; }
std::string cell(const std::optional<double>& value, const char* format) {
    return cell(value ? fmt::format(fmt::runtime(format), *value) : "");
}
std::string fixed_cell(const std::optional<double>& value, int decimals) {
    return cell(value ? fixed_text(*value, decimals) : "");
}
std::optional<double> if_timed(double value) { return value > 0 ? std::optional(value) : std::nullopt; }

std::string table(const std::vector<std::string>& head, const std::string& rows) {
    std::string names;
    for (const std::string& name : head) names += "<th>" + html_text(name) + "</th>";
    return "<table><tr>" + names + "</tr>\n" + rows + "</table>\n";
}

/// The run that is a figure of its own, or null.
const RunFigures* own_run(const CombinationFigures& c, uint32_t set) {
    const RunFigures* run = find_run(c, set);
    return run != nullptr && !run->is_copy && !c.wrong && run->median_s > 0 ? run : nullptr;
}

/// By name, and with figures.
const CombinationFigures* find_measured(const LabReport& report, const Combination& wanted) {
    const std::string name = name_of(wanted);
    const auto at = std::ranges::find_if(
        report.combinations, [&](const CombinationFigures& c) { return c.name == name && !c.runs.empty(); });
    return at == report.combinations.end() ? nullptr : &*at;
}

struct Ratio {
    const char* title;
    const char* meaning;
    /// The combination to compare with; none: it is not of this table.
    std::function<std::optional<Combination>(Combination)> other;
    bool is_price; // time of this one over the other's; else speed over speed
};

std::vector<Ratio> ratios() {
    const auto with = [](Combination c, Distribution d) {
        return c.distribution == d ? std::optional(Combination{c.structure, c.walk, c.options, {}}) : std::nullopt;
    };
    return {{"RTA on against off", "Speed with redundant traversal avoidance over speed without; above 1 it pays.",
             [](Combination c) {
                 const bool has = std::exchange(c.options.rta, false);
                 c.options.rta_at_pops = true;
                 return has ? std::optional(c) : std::nullopt;
             },
             false},
            {"RTA at pops too against at nodes alone", "Speed with over speed without; above 1 it pays.",
             [](Combination c) {
                 const bool has = c.options.rta && std::exchange(c.options.rta_at_pops, false);
                 return has ? std::optional(c) : std::nullopt;
             },
             false},
            {"Near child first against the builder's order", "Speed with over speed without; above 1 it pays.",
             [](Combination c) {
                 const std::string name = name_of(c);
                 const bool has = std::exchange(c.options.near_first, false);
                 return has && name_of(c) != name ? std::optional(c) : std::nullopt;
             },
             false},
            {"Persistent threads against one ray a thread", "Speed with over speed without; above 1 they pay.",
             [with](const Combination& c) { return with(c, Distribution::Persistent); }, false},
            {"Dynamic fetch against one ray a thread", "Speed with over speed without; above 1 it pays.",
             [with](const Combination& c) { return with(c, Distribution::DynamicFetch); }, false},
            {"The price of exactness",
             "Time with exact tests over time with fast ones, which lose rays at edges; above 1 exactness costs.",
             [](Combination c) {
                 const TestKind had = std::exchange(c.options.tests, TestKind::Fast);
                 return had == TestKind::Exact ? std::optional(c) : std::nullopt;
             },
             true},
            {"The price of exactness against Woop's unit-triangle test",
             "The same over time with the test of Aila and Laine's kernels.",
             [](Combination c) {
                 const TestKind had = std::exchange(c.options.tests, TestKind::Woop);
                 return had == TestKind::Exact ? std::optional(c) : std::nullopt;
             },
             true}};
}

std::string html_of(const LabReport& report, const Ratio& ratio) {
    std::string rows;
    for (const CombinationFigures& c : report.combinations) {
        const std::optional<Combination> other = ratio.other(c.combination);
        const CombinationFigures* d = other ? find_measured(report, *other) : nullptr;
        if (d == nullptr) continue;
        std::string row;
        bool any = false;
        for (uint32_t set = 0; set < report.sets.size(); ++set) {
            const RunFigures *here = own_run(c, set), *there = own_run(*d, set);
            std::optional<double> value;
            if (here != nullptr && there != nullptr) {
                value = ratio.is_price ? here->median_s / there->median_s : there->median_s / here->median_s;
            }
            any = any || value;
            row += cell(value, "{:.3f}");
        }
        if (any) rows += "<tr>" + cell(c.name) + row + "</tr>\n";
    }
    if (rows.empty()) return {};
    std::vector<std::string> head = {"combination"};
    for (const SetFigures& set : report.sets) head.push_back(set.name);
    return fmt::format("<h3>{}</h3>\n<p>{}</p>\n", html_text(ratio.title), html_text(ratio.meaning)) +
           table(head, rows);
}

bool is_plain(const Combination& c) {
    return c.options.rta && c.options.rta_at_pops && c.options.near_first && c.options.is_exact() &&
           c.distribution == Distribution::OneAThread;
}

std::string matrix_of(const LabReport& report, uint32_t set) {
    std::vector<WalkKind> walks;
    std::vector<StructureKind> structures;
    const auto find = [&](StructureKind structure, WalkKind walk) -> const RunFigures* {
        for (const CombinationFigures& c : report.combinations) {
            if (c.combination.structure != structure || c.combination.walk != walk || !is_plain(c.combination))
                continue;
            if (const RunFigures* run = find_run(c, set); run != nullptr && run->median_s > 0 && !c.wrong) return run;
        }
        return nullptr;
    };
    for (const WalkKind walk : kValuesOf<WalkKind>) {
        if (std::ranges::any_of(kValuesOf<StructureKind>, [&](StructureKind s) { return find(s, walk) != nullptr; })) {
            walks.push_back(walk);
        }
    }
    std::string rows;
    for (const StructureKind structure : kValuesOf<StructureKind>) {
        std::string row;
        bool any = false;
        for (const WalkKind walk : walks) {
            const RunFigures* run = find(structure, walk);
            any = any || run != nullptr;
            row += cell(run != nullptr ? std::optional(mrays(report, *run)) : std::nullopt, "{:.2f}");
        }
        if (any) rows += "<tr>" + cell(name_of(structure)) + row + "</tr>\n";
    }
    if (rows.empty()) return {};
    std::vector<std::string> head = {"structure"};
    for (const WalkKind walk : walks) head.emplace_back(name_of(walk));
    return fmt::format("<h3>{}</h3>\n", html_text(report.sets[set].name)) + table(head, rows);
}

std::string figures_row(const LabReport& report, const CombinationFigures& c, const RunFigures& run, bool has_warps) {
    const SetFigures& set = report.sets[run.set];
    const std::optional<double> frame_s = set.depth > 0 ? frame_seconds(report, c, set.depth) : std::nullopt;
    const bool of_kernel = !set.any_hit;
    std::string row = "<tr>" + cell(c.name) + cell(set.name + (run.is_copy ? ", same walk" : "")) +
                      fixed_cell(if_timed(mrays(report, run)), 2) +
                      fixed_cell(if_timed(mrays(report, run, run.largest_s)), 2) +
                      fixed_cell(if_timed(mrays(report, run, run.least_s)), 2);
    row += fixed_cell(frame_s ? std::optional(1 / *frame_s) : std::nullopt, 2) + fixed_cell(frame_s, 5) +
           cell(price_of_exactness(report, c, run.set), "{:.3f}") + cell(run.nodes, "{:.2f}") +
           cell(run.triangles, "{:.2f}");
    if (has_warps) {
        row += cell(run.node_lanes, "{:.1f}") + cell(run.triangle_lanes, "{:.1f}") + cell(run.node_sectors, "{:.1f}") +
               cell(run.triangle_sectors, "{:.1f}") + cell(of_kernel ? c.registers : std::nullopt, "{:.0f}") +
               cell(of_kernel ? c.local_bytes : std::nullopt, "{:.0f}") +
               cell(of_kernel && c.occupancy ? std::optional(100 * *c.occupancy) : std::nullopt, "{:.0f} %");
    }
    return row + cell(fmt::format("{}", run.different)) + "</tr>\n";
}

} // namespace

std::string html_wrong(const LabReport& report) {
    std::string names;
    for (const CombinationFigures& c : report.combinations) {
        if (c.wrong) names += "<br>" + html_text(c.name) + ": " + html_text(c.refused);
    }
    if (names.empty()) return {};
    return "<p class=\"wrong\"><strong>WRONG: these combinations differ from the proven walk (the one "
           "that is held against brute force) and have no figures.</strong>" +
           names + "</p>\n";
}

std::string html_sets(const LabReport& report) {
    std::string rows;
    for (const SetFigures& set : report.sets) {
        rows += "<tr>" + cell(set.name) + cell(set.any_hit ? "any hit" : "closest hit") +
                cell(set.depth > 0 ? fmt::format("{}", set.depth) : "") + cell(fmt::format("{}", set.rays)) +
                cell(fmt::format("{:.1f} %", 100 * set.hit_share)) + cell(fmt::format("{}", set.brute_force_rays)) +
                "</tr>\n";
    }
    std::string notes;
    for (const std::string& note : report.notes) notes += "<li>" + html_text(note) + "</li>\n";
    if (!notes.empty()) notes = "<ul>\n" + notes + "</ul>\n";
    if (rows.empty()) return notes;
    return table({"set", "kind", "depth", "rays", "that hit",
                  "rays that were also tested against every triangle (brute force)"},
                 rows) +
           notes;
}

std::string html_structures(const LabReport& report) {
    const std::vector<std::string> head = {"structure", "build, s",         "nodes",    "triangles in leaves",
                                           "MiB",       "bytes a triangle", "SAH cost", "depth"};
    std::string rows;
    for (const StructureFigures& s : report.structures) {
        if (!s.failed.empty()) {
            rows += fmt::format("<tr>{}<td colspan=\"{}\">{}</td></tr>\n", cell(s.name), head.size() - 1,
                                html_text(s.failed));
            continue;
        }
        rows += "<tr>" + cell(s.name) + fixed_cell(s.build_s, 3) + cell(fmt::format("{}", s.nodes)) +
                cell(fmt::format("{}", s.triangles)) + cell(mebibytes(s.bytes), "{:.2f}") +
                cell(static_cast<double>(s.bytes) / static_cast<double>(std::max<uint64_t>(report.triangles, 1)),
                     "{:.1f}") +
                cell(s.sah_cost, "{:.2f}") + cell(s.depth ? fmt::format("{}", *s.depth) : "") + "</tr>\n";
    }
    return rows.empty() ? "" : table(head, rows);
}

std::string html_matrices(const LabReport& report) {
    std::string html;
    for (uint32_t set = 0; set < report.sets.size(); ++set) html += matrix_of(report, set);
    if (html.empty()) return {};
    return "<h2>Structures and walks</h2>\n<p>Million rays a second, exact tests, all switches on, one ray a "
           "thread.</p>\n" +
           html;
}

std::string html_ratios(const LabReport& report) {
    std::string html;
    for (const Ratio& ratio : ratios()) html += html_of(report, ratio);
    return html.empty() ? "" : "<h2>What the switches bring</h2>\n" + html;
}

std::string html_figures(const LabReport& report) {
    const bool has_warps = std::ranges::any_of(report.combinations, [](const CombinationFigures& c) {
        return c.registers || c.occupancy ||
               std::ranges::any_of(c.runs, [](const RunFigures& run) { return run.node_lanes || run.node_sectors; });
    });
    std::vector<std::string> head = {"combination", "rays",           "Mrays/s", "slowest",
                                     "fastest",     "frames/s",       "s/frame", "price of exactness",
                                     "nodes a ray", "triangles a ray"};
    if (has_warps) {
        head.insert(head.end(), {"lanes, nodes", "lanes, triangles", "sectors, nodes", "sectors, triangles",
                                 "registers", "local bytes", "occupancy allowed"});
    }
    head.emplace_back("rays that differ");
    std::string rows;
    for (const CombinationFigures& c : report.combinations) {
        for (const RunFigures& run : c.runs) rows += figures_row(report, c, run, has_warps);
    }
    if (rows.empty()) return {};
    return "<h2>All figures</h2>\n<p>A frame of depth d is one camera ray a pixel and its d - 1 diffuse bounces. "
           "Mrays/s are of the median run, with those of the slowest and the fastest run beside. \"Same walk\": an "
           "equal walk was measured for "
           "another combination, and its figures stand here too. Price of exactness: time over that of the same "
           "combination with fast tests. An empty cell was not measured.</p>\n" +
           table(head, rows) + kNodeNote + (has_warps ? kWarpNote : "");
}

std::string html_not_run(const LabReport& report) {
    std::string items;
    for (const auto& [reason, names] : refusals_by_reason(report.combinations)) {
        items += fmt::format("<li><strong>{}</strong>: {}</li>\n", html_text(reason),
                             html_text(fmt::format("{}", fmt::join(names, ", "))));
    }
    return items.empty() ? "" : "<h2>Not run</h2>\n<ul>\n" + items + "</ul>\n";
}

} // namespace pertev
