#include "lab/thesis.h"

#include <algorithm>

#include <fmt/format.h>

#include "lab/svg_plot.h"
#include "lab/text_table.h"
#include "lab/write_html.h"

namespace pertev {
namespace {

constexpr const char* kTree = "Every column walks the same tree: binned, top down by the surface area heuristic.";

constexpr WalkOptions kWithRta = {.rta = true, .near_first = true};
constexpr WalkOptions kWithoutRta = {.rta = false, .near_first = true};
constexpr WalkOptions kWoop = {.rta = true, .near_first = true, .tests = TestKind::Woop};

Combination speculative(const WalkOptions& options, Distribution distribution) {
    return {StructureKind::Binned, WalkKind::Speculative, options, distribution};
}
Combination packet(const WalkOptions& options, Distribution distribution) {
    return {StructureKind::Binned, WalkKind::Packet, options, distribution};
}

bool on_cuda(const ThesisReport& thesis) { return !thesis.scenes.empty() && thesis.scenes.front().device != "CPU"; }

const CombinationFigures* find(const LabReport& report, const Combination& wanted) {
    const std::string name = name_of(wanted);
    const auto at =
        std::ranges::find_if(report.combinations, [&](const CombinationFigures& c) { return c.name == name; });
    return at == report.combinations.end() ? nullptr : &*at;
}

/// None where the variant has no figures of a frame so deep.
std::optional<double> seconds_of(const LabReport& report, const ThesisVariant& v, int depth) {
    const CombinationFigures* c = find(report, v.combination);
    return c != nullptr && !c->wrong ? frame_seconds(report, *c, depth) : std::nullopt;
}

struct Table {
    std::string title;
    std::vector<std::vector<std::string>> rows; // the first is the head
};

enum class Quantity { Frames, Rays };

std::string figure_text(const LabReport& report, int depth, double seconds, Quantity quantity) {
    if (quantity == Quantity::Frames) {
        return fmt::format("{} ({})", fixed_text(1 / seconds, 2), fixed_text(seconds, 5));
    }
    return fixed_text(static_cast<double>(frame_rays(report, depth)) / seconds * 1e-6, 2);
}

/// Of one scene: a row a depth, a column a variant.
Table make_table(const LabReport& report, bool is_cuda, const std::string& title, Quantity quantity) {
    Table table = {title, {{"depth"}}};
    const std::vector<ThesisVariant> variants = thesis_variants(is_cuda);
    for (const ThesisVariant& v : variants) table.rows[0].emplace_back(v.name);
    for (int depth = report.first_depth; depth <= largest_depth(report); ++depth) {
        std::vector<std::string> row = {fmt::format("{}", depth)};
        for (const ThesisVariant& v : variants) {
            const CombinationFigures* c = find(report, v.combination);
            const std::optional<double> seconds = seconds_of(report, v, depth);
            row.push_back(seconds ? figure_text(report, depth, *seconds, quantity)
                                  : (c != nullptr && c->wrong ? "WRONG" : "-"));
        }
        table.rows.push_back(row);
    }
    return table;
}

std::vector<Table> tables_of(const ThesisReport& thesis) {
    std::vector<Table> tables;
    int number = 3;
    for (const LabReport& report : thesis.scenes) {
        tables.push_back(
            make_table(report, on_cuda(thesis),
                       fmt::format("Table 6.{}: {}, frames a second (seconds a frame)", number++, report.scene),
                       Quantity::Frames));
        tables.push_back(make_table(report, on_cuda(thesis),
                                    fmt::format("Table 6.{}: {}, million rays a second", number++, report.scene),
                                    Quantity::Rays));
    }
    return tables;
}

/// Why a variant has no figures, or not all; empty: it has them.
std::string missing(const LabReport& report, const ThesisVariant& v) {
    const CombinationFigures* c = find(report, v.combination);
    if (c == nullptr) return "it is not in the report";
    if (c->wrong) return c->refused.starts_with("WRONG") ? c->refused : "WRONG: " + c->refused;
    if (!c->refused.empty()) return c->refused;
    for (int depth = report.first_depth; depth <= largest_depth(report); ++depth) {
        if (frame_seconds(report, *c, depth)) continue;
        return report.interrupted ? fmt::format("interrupted before depth {}", depth)
                                  : fmt::format("not timed at depth {}", depth);
    }
    return {};
}

/// What stands below the tables, a line each: interruptions, what is missing, what tests that leak lose.
std::vector<std::string> notes_of(const ThesisReport& thesis) {
    std::vector<std::string> notes;
    for (const LabReport& report : thesis.scenes) {
        if (report.interrupted) {
            notes.push_back(fmt::format("{}: interrupted; this is what had been measured.", report.scene));
        }
        for (const ThesisVariant& v : thesis_variants(on_cuda(thesis))) {
            const std::string why = missing(report, v);
            if (!why.empty()) notes.push_back(fmt::format("{}, {}: {}", report.scene, v.name, why));
            const CombinationFigures* c = find(report, v.combination);
            if (v.combination.options.is_exact() || c == nullptr) continue;
            for (const RunFigures& run : c->runs) {
                const SetFigures& set = report.sets[run.set];
                notes.push_back(fmt::format("{}, {}: {} of {} {} rays differ from the exact result.", report.scene,
                                            v.name, run.different, set.rays, set.name));
            }
        }
    }
    if (thesis.scenes.empty()) notes.emplace_back("Nothing was measured.");
    if (thesis.scenes.size() == 1) notes.emplace_back("The second scene was not measured.");
    return notes;
}

/// Frames a second over depth of the variants of these names, in all scenes.
ThesisFigure figure_of(const ThesisReport& thesis, const char* number, const std::string& title,
                       const std::vector<std::string>& names) {
    std::vector<Curve> curves;
    bool has_variant = false;
    for (const ThesisVariant& v : thesis_variants(on_cuda(thesis))) {
        if (std::ranges::find(names, v.name) == names.end()) continue;
        has_variant = true;
        for (const LabReport& report : thesis.scenes) {
            Curve curve = {fmt::format("{}: {}", report.scene, v.name), {}};
            for (int depth = report.first_depth; depth <= largest_depth(report); ++depth) {
                if (const auto seconds = seconds_of(report, v, depth)) curve.points.emplace_back(depth, 1 / *seconds);
            }
            if (!curve.points.empty()) curves.push_back(std::move(curve));
        }
    }
    const std::string full = fmt::format("Figure {}: {}", number, title);
    ThesisFigure figure = {number, full, svg_curves(full, "depth", "frames/s", curves), {}};
    if (figure.svg.empty()) {
        figure.missing = !has_variant     ? "needs a GPU"
                         : curves.empty() ? "was not measured; the notes say why"
                                          : "needs more than one depth; the tables have what there is";
    }
    return figure;
}

std::string html_of(const Table& table) {
    std::string rows;
    for (std::size_t i = 0; i < table.rows.size(); ++i) {
        const char* tag = i == 0 ? "th" : "td";
        rows += "<tr>";
        for (const std::string& text : table.rows[i]) rows += fmt::format("<{0}>{1}</{0}>", tag, html_text(text));
        rows += "</tr>\n";
    }
    return fmt::format("<h2>{}</h2>\n<table>{}</table>\n", html_text(table.title), rows);
}

std::string pictures_of(const ThesisReport& thesis) {
    std::string html;
    for (std::size_t i = 0; i < std::max(thesis.local.size(), thesis.global.size()); ++i) {
        html += fmt::format("<h2>Figure 6.{}: local and global illumination</h2>\n", 7 + i);
        for (const auto* pictures : {&thesis.local, &thesis.global}) {
            if (i < pictures->size()) html += html_image((*pictures)[i].image, (*pictures)[i].caption, 512);
        }
    }
    return html;
}

std::string about(const LabReport& report) {
    std::string text =
        fmt::format("{}: {} triangles, {}x{}, {} runs after {} for warming up, on {}", report.scene, report.triangles,
                    report.width, report.height, report.runs, report.warm_ups, report.device);
    if (report.device == "CPU" && report.threads > 0) text += fmt::format(" with {} threads", report.threads);
    if (!report.camera.empty()) text += ", camera " + report.camera;
    return text + fmt::format(", pertev {}.", report.commit);
}

} // namespace

std::vector<ThesisVariant> thesis_variants(bool is_cuda) {
    using enum Distribution;
    if (!is_cuda) {
        return {{"SWW", "speculative while-while; on a CPU no lanes wait for each other, so it is plain while-while",
                 speculative(kWithRta, OneAThread)},
                {"SWW-R", "the same without RTA", speculative(kWithoutRta, OneAThread)},
                {"Packet", "eight rays share a stack", packet(kWithRta, OneAThread)},
                {"Packet-R", "the same without RTA", packet(kWithoutRta, OneAThread)},
                {"A",
                 "SWW with Aila and Laine's triangle test, Woop's unit-triangle transform, and boxes without growth, "
                 "which lose rays at edges; their dynamic fetch needs a GPU",
                 speculative(kWoop, OneAThread)}};
    }
    return {{"SWW", "speculative while-while, one ray a thread", speculative(kWithRta, OneAThread)},
            {"SWW-R", "the same without RTA", speculative(kWithoutRta, OneAThread)},
            {"PSWW", "persistent threads", speculative(kWithRta, Persistent)},
            {"PSWW-R", "the same without RTA", speculative(kWithoutRta, Persistent)},
            {"PPacket", "persistent packets: a warp shares a stack", packet(kWithRta, Persistent)},
            {"PPacket-R", "the same without RTA", packet(kWithoutRta, Persistent)},
            {"A",
             "Aila and Laine's kernel: speculative while-while with dynamic fetch, Woop's unit-triangle transform and "
             "boxes without growth, which lose rays at edges",
             speculative(kWoop, DynamicFetch)}};
}

std::vector<ThesisFigure> figures_of(const ThesisReport& thesis) {
    return {figure_of(thesis, "6.9", "RTA with persistent speculative while-while", {"PSWW", "PSWW-R"}),
            figure_of(thesis, "6.10", "speculative while-while, with and without RTA", {"SWW", "SWW-R"}),
            figure_of(thesis, "6.11", "RTA with packets", {"PPacket", "PPacket-R", "Packet", "Packet-R"})};
}

std::string text_of(const ThesisReport& thesis) {
    std::string text;
    for (const ThesisVariant& v : thesis_variants(on_cuda(thesis))) {
        text += fmt::format("{:10} {}\n", v.name, v.meaning);
    }
    text += fmt::format("{}\n", kTree);
    for (const Table& table : tables_of(thesis)) text += '\n' + table.title + '\n' + align_columns(table.rows);
    text += '\n';
    for (const std::string& note : notes_of(thesis)) text += note + '\n';
    return text;
}

std::string html_of(const ThesisReport& thesis) {
    std::string body =
        "<p>Chapter 6 of Bellek 2014, measured anew. A frame of depth d is one camera ray a pixel and its "
        "d - 1 diffuse bounces; traversal alone. RTA: redundant traversal avoidance.</p>\n<ul>\n";
    for (const ThesisVariant& v : thesis_variants(on_cuda(thesis))) {
        body += fmt::format("<li>{}: {}</li>\n", html_text(v.name), html_text(v.meaning));
    }
    body += fmt::format("</ul>\n<p>{}</p>\n", kTree);
    for (const Table& table : tables_of(thesis)) body += html_of(table);
    const std::vector<std::string> notes = notes_of(thesis);
    if (!notes.empty()) {
        body += "<h2>Notes</h2>\n<ul>\n";
        for (const std::string& note : notes) {
            const bool is_alarm =
                note.find("WRONG") != std::string::npos || note.find("interrupted") != std::string::npos;
            body += fmt::format("<li{}>{}</li>\n", is_alarm ? " class=\"wrong\"" : "", html_text(note));
        }
        body += "</ul>\n";
    }
    body += pictures_of(thesis);
    for (const ThesisFigure& figure : figures_of(thesis)) {
        body +=
            figure.svg.empty() ? fmt::format("<p>{}: {}.</p>\n", html_text(figure.title), figure.missing) : figure.svg;
    }
    for (const LabReport& report : thesis.scenes) body += "<p>" + html_text(about(report)) + "</p>\n";
    return html_page("Realtime photo-realistic rendering using modern GPU systems, chapter 6, measured anew", body);
}

} // namespace pertev
