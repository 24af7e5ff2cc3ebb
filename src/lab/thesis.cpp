#include "lab/thesis.h"

#include <algorithm>
#include <span>

#include <fmt/format.h>

#include "lab/html_table.h"
#include "lab/svg_plot.h"
#include "lab/text_table.h"
#include "lab/write_html.h"
#include "lab/write_thesis_pictures.h"

namespace pertev {
namespace {

constexpr const char* kTree = "Every column walks the same tree: binned, top down by the surface area heuristic.";

const std::string kNotMade = "Not made: ";

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

using Names = std::vector<std::string>;

struct Table {
    std::string title;
    std::vector<std::vector<std::string>> rows; // the first is the head
};

/// The variants of these names that this kind of device has, in their own order.
std::vector<ThesisVariant> variants_named(const Names& names, bool is_cuda) {
    std::vector<ThesisVariant> variants = thesis_variants(is_cuda);
    std::erase_if(variants, [&](const ThesisVariant& v) { return std::ranges::find(names, v.name) == names.end(); });
    return variants;
}

/// Two columns a variant.
void add_head(const std::vector<ThesisVariant>& variants, std::vector<std::string>& head) {
    for (const ThesisVariant& v : variants) {
        head.push_back(fmt::format("{} frames/s (s)", v.name));
        head.push_back(fmt::format("{} Mrays/s", v.name));
    }
}

/// A row for each depth of the report, with `first` in front.
void add_rows(const LabReport& report, const std::vector<ThesisVariant>& variants,
              const std::vector<std::string>& first, Table& table) {
    for (int depth = report.first_depth; depth <= largest_depth(report); ++depth) {
        std::vector<std::string> row = first;
        row.push_back(fmt::format("{}", depth));
        for (const ThesisVariant& v : variants) {
            const CombinationFigures* c = find(report, v.combination);
            if (const std::optional<double> seconds = seconds_of(report, v, depth)) {
                const double rays = static_cast<double>(frame_rays(report, depth));
                row.push_back(fmt::format("{} ({})", fixed_text(1 / *seconds, 2), fixed_text(*seconds, 5)));
                row.push_back(fixed_text(rays / *seconds * 1e-6, 2));
            } else {
                row.insert(row.end(), 2, c != nullptr && c->wrong ? "WRONG" : "-");
            }
        }
        table.rows.push_back(row);
    }
}

/// Of one scene: a row a depth.
Table depth_table(const LabReport& report, const std::string& title, const std::vector<ThesisVariant>& variants) {
    Table table = {title, {{"depth"}}};
    add_head(variants, table.rows[0]);
    add_rows(report, variants, {}, table);
    return table;
}

/// Table 6.6.
Table peer_table(const ThesisReport& thesis) {
    const std::vector<ThesisVariant> variants =
        variants_named({"SWW", "PSWW", "Packet", "PPacket", "A"}, on_cuda(thesis));
    const LabReport& one = thesis.scenes.front();
    Table table = {fmt::format("Table 6.6: {} at {}x{} against Aila and Laine's kernel (A)",
                               thesis.scenes.size() > 1 ? "both scenes" : one.scene, one.width, one.height),
                   {{"scene", "depth"}}};
    add_head(variants, table.rows[0]);
    for (const LabReport& report : thesis.scenes) add_rows(report, variants, {report.scene}, table);
    return table;
}

/// How the pictures of chapters 2 to 4 were made, and in which time.
Table picture_table(const ThesisReport& thesis) { return {"Pictures of chapters 2 to 4", table_of(thesis.pictures)}; }

/// As the thesis's captions number them, and then what its figures draw and no table has.
std::vector<Table> tables_of(const ThesisReport& thesis) {
    const bool is_cuda = on_cuda(thesis);
    const char* const both_ways =
        is_cuda ? "with and without persistent threads" : "without persistent threads, which a CPU has not got";
    const char* const without_rta = is_cuda ? "with persistent threads and without RTA"
                                            : "without RTA, and without persistent threads, which a CPU has not got";
    const Names in_figures = {"SWW-R", "PSWW-R", "Packet-R", "PPacket-R"};
    const Names of_table_5 = is_cuda ? Names{"PSWW-R", "PPacket-R"} : Names{"SWW-R", "Packet-R"};
    std::vector<Table> tables, beside;
    for (std::size_t i = 0; i < thesis.scenes.size(); ++i) {
        const LabReport& report = thesis.scenes[i];
        tables.push_back(depth_table(report, fmt::format("Table 6.{}: {} {}", 3 + i, report.scene, both_ways),
                                     variants_named({"SWW", "PSWW", "Packet", "PPacket"}, is_cuda)));
        std::vector<ThesisVariant> rest = variants_named(in_figures, is_cuda);
        if (i > 0) {
            const std::string title = fmt::format("Table 6.5: {} {}", report.scene, without_rta);
            tables.push_back(depth_table(report, title, variants_named(of_table_5, is_cuda)));
            std::erase_if(rest, [&](const ThesisVariant& v) {
                return std::ranges::find(of_table_5, v.name) != of_table_5.end();
            });
        }
        const std::string title = fmt::format("Figures 6.9 to 6.11 beside: {} without RTA", report.scene);
        if (!rest.empty()) beside.push_back(depth_table(report, title, rest));
    }
    if (!thesis.scenes.empty()) tables.push_back(peer_table(thesis));
    tables.insert(tables.end(), beside.begin(), beside.end());
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
    for (const std::string& line : thesis.lacking) notes.push_back(kNotMade + line);
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
    if (thesis.scenes.size() == 1 && thesis.lacking.empty()) notes.emplace_back("The second scene was not measured.");
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
    return fmt::format("<h3>{}</h3>\n{}", html_text(table.title), html_table(table.rows));
}

std::string pictures_of(const ThesisReport& thesis) {
    std::string html;
    for (std::size_t i = 0; i < std::max(thesis.local.size(), thesis.global.size()); ++i) {
        std::string images;
        for (const auto* pictures : {&thesis.local, &thesis.global}) {
            const bool is_there = i < pictures->size() && !(*pictures)[i].image.pixels.empty();
            if (is_there) images += html_image((*pictures)[i].image, (*pictures)[i].caption, 512);
        }
        if (images.empty()) continue;
        html += fmt::format("<h3>Figure 6.{}: local and global illumination</h3>\n{}", 7 + i, images);
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
    if (const Table pictures = picture_table(thesis); pictures.rows.size() > 1) {
        text += '\n' + pictures.title + '\n' + align_columns(pictures.rows);
    }
    text += '\n';
    for (const std::string& note : notes_of(thesis)) text += note + '\n';
    return text;
}

std::string html_of(const ThesisReport& thesis) {
    std::string body;
    const std::vector<std::string> notes = notes_of(thesis);
    if (!notes.empty()) {
        body += "<h2>Notes</h2>\n<ul>\n";
        for (const std::string& note : notes) {
            const bool is_alarm = note.find("WRONG") != std::string::npos ||
                                  note.find("interrupted") != std::string::npos || note.starts_with(kNotMade);
            body += fmt::format("<li{}>{}</li>\n", is_alarm ? " class=\"wrong\"" : "", html_text(note));
        }
        body += "</ul>\n";
    }
    body += html_of(std::span(thesis.pictures));
    if (const Table pictures = picture_table(thesis); pictures.rows.size() > 1) body += html_of(pictures);
    body += "<h2>Chapter 6</h2>\n<p>Measured anew. A frame of depth d is one camera ray a pixel and its d - 1 diffuse "
            "bounces; traversal alone. RTA: redundant traversal avoidance.</p>\n<ul>\n";
    for (const ThesisVariant& v : thesis_variants(on_cuda(thesis))) {
        body += fmt::format("<li>{}: {}</li>\n", html_text(v.name), html_text(v.meaning));
    }
    body += fmt::format("</ul>\n<p>{}</p>\n", kTree);
    for (const Table& table : tables_of(thesis)) body += html_of(table);
    body += pictures_of(thesis);
    for (const ThesisFigure& figure : figures_of(thesis)) {
        body +=
            figure.svg.empty() ? fmt::format("<p>{}: {}.</p>\n", html_text(figure.title), figure.missing) : figure.svg;
    }
    for (const LabReport& report : thesis.scenes) body += "<p>" + html_text(about(report)) + "</p>\n";
    const char* chapters = thesis.pictures.empty() ? "chapter 6" : "chapters 2 to 4 and 6";
    return html_page(
        fmt::format("Bellek 2014, Realtime photo-realistic rendering using modern GPU systems: {} made anew", chapters),
        body);
}

} // namespace pertev
