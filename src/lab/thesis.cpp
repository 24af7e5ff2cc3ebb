#include "lab/thesis.h"

#include <algorithm>
#include <array>

#include <fmt/format.h>

#include "lab/svg_plot.h"
#include "lab/write_html.h"

namespace pertev {
namespace {

constexpr WalkOptions kWithRta = {.rta = true, .near_first = true, .exact = true};
constexpr WalkOptions kWithoutRta = {.rta = false, .near_first = true, .exact = true};
constexpr WalkOptions kFast = {.rta = true, .near_first = true, .exact = false};

Combination speculative(const WalkOptions& options, Distribution distribution) {
    return {StructureKind::Binned, WalkKind::Speculative, options, distribution};
}
Combination packet(const WalkOptions& options, Distribution distribution) {
    return {StructureKind::Binned, WalkKind::Packet, options, distribution};
}

const CombinationFigures* find(const LabReport& report, const Combination& wanted) {
    const std::string name = name_of(wanted);
    const auto at =
        std::ranges::find_if(report.combinations, [&](const CombinationFigures& c) { return c.name == name; });
    return at == report.combinations.end() ? nullptr : &*at;
}

struct Table {
    std::string title;
    std::vector<std::string> head;
    std::vector<std::vector<std::string>> rows;
};

/// Of one scene: frames a second and seconds a frame (quantity 0), or million rays a second (quantity 1).
Table make_table(const LabReport& report, bool is_cuda, const std::string& title, int quantity) {
    Table table = {title, {"depth"}, {}};
    const std::vector<ThesisVariant> variants = thesis_variants(is_cuda);
    for (const ThesisVariant& v : variants) table.head.emplace_back(v.name);
    for (int depth = report.first_depth; depth <= largest_depth(report); ++depth) {
        std::vector<std::string> row = {fmt::format("{}", depth)};
        for (const ThesisVariant& v : variants) {
            const CombinationFigures* c = find(report, v.combination);
            const double seconds = c != nullptr ? frame_seconds(report, *c, depth) : 0;
            if (!(seconds > 0)) {
                row.emplace_back("-");
            } else if (quantity == 0) {
                row.push_back(fmt::format("{:.2f} ({:.5f})", 1 / seconds, seconds));
            } else {
                row.push_back(fmt::format("{:.2f}", static_cast<double>(frame_rays(report, depth)) / seconds * 1e-6));
            }
        }
        table.rows.push_back(row);
    }
    return table;
}

bool on_cuda(const ThesisReport& thesis) { return !thesis.scenes.empty() && thesis.scenes.front().device != "CPU"; }

std::vector<Table> tables_of(const ThesisReport& thesis) {
    std::vector<Table> tables;
    int number = 3;
    for (const LabReport& report : thesis.scenes) {
        tables.push_back(
            make_table(report, on_cuda(thesis),
                       fmt::format("Table 6.{}: {}, frames a second (seconds a frame)", number++, report.scene), 0));
        tables.push_back(make_table(report, on_cuda(thesis),
                                    fmt::format("Table 6.{}: {}, million rays a second", number++, report.scene), 1));
    }
    return tables;
}

/// Frames a second over depth of the variants that begin with `prefix`, in all scenes.
std::string figure_of(const ThesisReport& thesis, const std::string& title, const std::vector<std::string>& names) {
    std::vector<Curve> curves;
    for (const LabReport& report : thesis.scenes) {
        for (const ThesisVariant& v : thesis_variants(on_cuda(thesis))) {
            if (std::ranges::find(names, v.name) == names.end()) continue;
            const CombinationFigures* c = find(report, v.combination);
            Curve curve = {fmt::format("{}: {}", report.scene, v.name), {}};
            for (int depth = report.first_depth; c != nullptr && depth <= largest_depth(report); ++depth) {
                const double seconds = frame_seconds(report, *c, depth);
                if (seconds > 0) curve.points.emplace_back(depth, 1 / seconds);
            }
            if (!curve.points.empty()) curves.push_back(std::move(curve));
        }
    }
    return svg_curves(title, "depth", "frames/s", curves);
}

std::string html_of(const Table& table) {
    std::string rows = "<tr>";
    for (const std::string& name : table.head) rows += "<th>" + html_text(name) + "</th>";
    rows += "</tr>\n";
    for (const auto& row : table.rows) {
        rows += "<tr>";
        for (const std::string& text : row) rows += "<td>" + html_text(text) + "</td>";
        rows += "</tr>\n";
    }
    return fmt::format("<h2>{}</h2>\n<table>{}</table>\n", html_text(table.title), rows);
}

} // namespace

std::vector<ThesisVariant> thesis_variants(bool is_cuda) {
    using enum Distribution;
    if (!is_cuda) {
        return {{"SWW", "speculative while-while", speculative(kWithRta, OneAThread)},
                {"SWW-R", "without RTA", speculative(kWithoutRta, OneAThread)},
                {"Packet", "eight rays share a stack", packet(kWithRta, OneAThread)},
                {"Packet-R", "without RTA", packet(kWithoutRta, OneAThread)},
                {"A", "the tests of Aila and Laine, which leak at edges", speculative(kFast, OneAThread)}};
    }
    return {{"SWW", "speculative while-while, one ray a thread", speculative(kWithRta, OneAThread)},
            {"SWW-R", "the same without RTA", speculative(kWithoutRta, OneAThread)},
            {"PSWW", "persistent threads", speculative(kWithRta, Persistent)},
            {"PSWW-R", "the same without RTA", speculative(kWithoutRta, Persistent)},
            {"PPacket", "persistent packets: a warp shares a stack", packet(kWithRta, Persistent)},
            {"PPacket-R", "the same without RTA", packet(kWithoutRta, Persistent)},
            {"A", "Aila and Laine: dynamic fetch, tests that leak at edges", speculative(kFast, DynamicFetch)}};
}

std::string text_of(const ThesisReport& thesis) {
    std::string text;
    for (const ThesisVariant& v : thesis_variants(on_cuda(thesis)))
        text += fmt::format("{:10} {}\n", v.name, v.meaning);
    for (const Table& table : tables_of(thesis)) {
        text += '\n' + table.title + '\n';
        for (const std::string& name : table.head) text += fmt::format("{:>20}", name);
        text += '\n';
        for (const auto& row : table.rows) {
            for (const std::string& cell : row) text += fmt::format("{:>20}", cell);
            text += '\n';
        }
    }
    return text;
}

std::string html_of(const ThesisReport& thesis) {
    std::string body =
        "<p>Chapter 6 of Bellek 2014, measured anew. A frame of depth d is one camera ray a pixel and its "
        "d - 1 diffuse bounces; traversal alone.</p>\n<ul>\n";
    for (const ThesisVariant& v : thesis_variants(on_cuda(thesis))) {
        body += fmt::format("<li>{}: {}</li>\n", html_text(v.name), html_text(v.meaning));
    }
    body += "</ul>\n";
    for (const Table& table : tables_of(thesis)) body += html_of(table);
    for (std::size_t i = 0; i < thesis.local.size() && i < thesis.global.size(); ++i) {
        body += fmt::format("<h2>Figure 6.{}: local and global illumination</h2>\n", 7 + i);
        body += html_image(thesis.local[i].image, thesis.local[i].caption, 512);
        body += html_image(thesis.global[i].image, thesis.global[i].caption, 512);
    }
    body += figure_of(thesis, "Figure 6.9: RTA with persistent speculative while-while", {"PSWW", "PSWW-R"});
    body += figure_of(thesis, "Figure 6.10: speculative while-while, with and without RTA", {"SWW", "SWW-R"});
    body += figure_of(thesis, "Figure 6.11: RTA with packets", {"PPacket", "PPacket-R", "Packet", "Packet-R"});
    for (const LabReport& report : thesis.scenes) {
        body += fmt::format("<p>{}: {} triangles, {}x{}, {} runs after {} for warming up, on {}, pertev {}.</p>\n",
                            html_text(report.scene), report.triangles, report.width, report.height, report.runs,
                            report.warm_ups, html_text(report.device), html_text(report.commit));
    }
    return html_page("Realtime photo-realistic rendering using modern GPU systems, chapter 6, measured anew", body);
}

} // namespace pertev
