#include "lab/write_tables.h"

#include <algorithm>

#include <fmt/format.h>

#include "base/json_text.h"

namespace pertev {
namespace {

std::string csv_text(const std::string& text) {
    if (text.find_first_of(",\"\n\r") == std::string::npos) return text;
    std::string quoted = "\"";
    for (const char c : text) {
        quoted += c;
        if (c == '"') quoted += c;
    }
    return quoted + '"';
}

/// Empty where there is no figure.
std::string measured(double value, const char* format) {
    return value > 0 ? fmt::format(fmt::runtime(format), value) : "";
}

std::string csv_head_of(const LabReport& report, const CombinationFigures& c) {
    const WalkOptions& o = c.combination.options;
    const StructureFigures& s = report.structures[c.structure];
    return fmt::format("{},{},{},{},{},{},{},{},{},{},{},{},{},{},{:.4f},{:.3f},{},{},{},{}", csv_text(report.scene),
                       csv_text(report.device), report.triangles, csv_text(c.name), name_of(c.combination.structure),
                       name_of(c.combination.walk), o.rta ? 1 : 0, o.near_first ? 1 : 0, o.exact ? 1 : 0,
                       name_of(c.combination.distribution), c.registers > 0 ? fmt::format("{}", c.registers) : "",
                       measured(c.occupancy, "{:.3f}"), s.nodes, s.triangles, s.build_s, s.sah_cost, s.depth, s.bytes,
                       report.runs, csv_text(c.refused));
}

std::string json_of(const StructureFigures& s) {
    return fmt::format(
        R"({{"name":{},"failed":{},"build_seconds":{},"nodes":{},"triangles":{},"bytes":{},"sah_cost":{},"depth":{}}})",
        json_string(s.name), json_string(s.failed), json_number(s.build_s), s.nodes, s.triangles, s.bytes,
        json_number(s.sah_cost), s.depth);
}

std::string json_of(const LabReport& report, const RunFigures& run) {
    return fmt::format(
        R"({{"set":{},"rays_per_second":{},"median_seconds":{},"least_seconds":{},"largest_seconds":{},"nodes_per_ray":{},"triangles_per_ray":{},"node_lanes":{},"triangle_lanes":{},"sectors_per_request":{},"different":{}}})",
        json_string(report.sets[run.set].name), json_number(mrays(report, run) * 1e6), json_number(run.median_s),
        json_number(run.least_s), json_number(run.largest_s), json_number(run.nodes), json_number(run.triangles),
        json_number(run.node_lanes), json_number(run.triangle_lanes), json_number(run.sectors), run.different);
}

std::string json_of(const LabReport& report, const CombinationFigures& c) {
    std::string runs, frames;
    for (const RunFigures& run : c.runs) runs += (runs.empty() ? "" : ",") + json_of(report, run);
    for (int depth = report.first_depth; depth <= largest_depth(report); ++depth) {
        frames += (frames.empty() ? "" : ",") + json_number(frame_seconds(report, c, depth));
    }
    return fmt::format(
        R"({{"name":{},"structure":"{}","walk":"{}","rta":{},"near_first":{},"exact":{},"distribution":"{}","refused":{},"registers":{},"occupancy":{},"frame_seconds":[{}],"runs":[{}]}})",
        json_string(c.name), name_of(c.combination.structure), name_of(c.combination.walk), c.combination.options.rta,
        c.combination.options.near_first, c.combination.options.exact, name_of(c.combination.distribution),
        json_string(c.refused), c.registers, json_number(c.occupancy), frames, runs);
}

} // namespace

std::string csv_of(const LabReport& report) {
    std::string csv = "scene,device,scene_triangles,combination,structure,walk,rta,near_first,exact,distribution,"
                      "registers,occupancy,nodes,leaf_triangles,build_seconds,sah_cost,depth,bytes,runs,refused,set,"
                      "rays,hit_share,rays_per_second,median_seconds,least_seconds,largest_seconds,frames_per_second,"
                      "seconds_per_frame,nodes_per_ray,triangles_per_ray,node_lanes,triangle_lanes,"
                      "sectors_per_request,different_rays\n";
    for (const CombinationFigures& c : report.combinations) {
        const std::string head = csv_head_of(report, c);
        if (c.runs.empty()) csv += head + ",,,,,,,,,,,,,,,\n";
        for (const RunFigures& run : c.runs) {
            const SetFigures& set = report.sets[run.set];
            const double frame_s = set.depth > 0 ? frame_seconds(report, c, set.depth) : 0;
            csv +=
                fmt::format("{},{},{},{:.5f},{:.0f},{:.7f},{:.7f},{:.7f},{},{},{:.3f},{:.3f},{},{},{},{}\n", head,
                            set.name, set.rays, set.hit_share, mrays(report, run) * 1e6, run.median_s, run.least_s,
                            run.largest_s, measured(frame_s > 0 ? 1 / frame_s : 0, "{:.3f}"),
                            measured(frame_s, "{:.7f}"), run.nodes, run.triangles, measured(run.node_lanes, "{:.2f}"),
                            measured(run.triangle_lanes, "{:.2f}"), measured(run.sectors, "{:.2f}"), run.different);
        }
    }
    return csv;
}

std::string json_of(const LabReport& report) {
    std::string sets, structures, combinations;
    for (const SetFigures& set : report.sets) {
        sets += fmt::format(R"({}{{"name":{},"any_hit":{},"depth":{},"rays":{},"hit_share":{},"brute_force_rays":{}}})",
                            sets.empty() ? "" : ",", json_string(set.name), set.any_hit, set.depth, set.rays,
                            json_number(set.hit_share), set.brute_force_rays);
    }
    for (const StructureFigures& s : report.structures) structures += (structures.empty() ? "" : ",") + json_of(s);
    for (const CombinationFigures& c : report.combinations) {
        combinations += (combinations.empty() ? "" : ",") + json_of(report, c);
    }
    return fmt::format(
        R"({{"event":"lab","scene":{},"device":{},"commit":{},"triangles":{},"instances":{},"width":{},"height":{},"first_depth":{},"runs":{},"warm_ups":{},"interrupted":{},"sets":[{}],"structures":[{}],"combinations":[{}]}})",
        json_string(report.scene), json_string(report.device), json_string(report.commit), report.triangles,
        report.instances, report.width, report.height, report.first_depth, report.runs, report.warm_ups,
        report.interrupted, sets, structures, combinations);
}

std::string text_of(const LabReport& report) {
    std::string text = fmt::format("{:24} {:>9} {:>10} {:>10} {:>9} {:>8} {:>5}\n", "structure", "build s", "nodes",
                                   "triangles", "MiB", "SAH cost", "depth");
    for (const StructureFigures& s : report.structures) {
        if (!s.failed.empty()) {
            text += fmt::format("{:24} {}\n", s.name, s.failed);
            continue;
        }
        text += fmt::format("{:24} {:9.3f} {:10} {:10} {:9.1f} {:8.2f} {:5}\n", s.name, s.build_s, s.nodes, s.triangles,
                            static_cast<double>(s.bytes) / 1048576.0, s.sah_cost, s.depth);
    }
    std::vector<const CombinationFigures*> order;
    for (const CombinationFigures& c : report.combinations) {
        if (!c.runs.empty()) order.push_back(&c);
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
    text += fmt::format("\nmillion rays a second on {} (nodes + triangles tested a ray)\n{:52}", report.device,
                        "combination");
    for (const SetFigures& set : report.sets) text += fmt::format(" {:>20}", set.name);
    text += '\n';
    for (const CombinationFigures* c : order) {
        text += fmt::format("{:52}", c->name);
        for (const RunFigures& run : c->runs) {
            text += fmt::format(" {:>20}",
                                fmt::format("{:.2f} ({:.1f} + {:.1f})", mrays(report, run), run.nodes, run.triangles));
        }
        text += '\n';
    }
    return text;
}

} // namespace pertev
