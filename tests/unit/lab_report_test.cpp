#include <doctest/doctest.h>

#include <algorithm>

#include "lab/html_tables.h"
#include "lab/text_table.h"
#include "lab/write_html.h"
#include "lab/write_tables.h"
#include "tests/support/small_lab_report.h"

using namespace pertev;
using namespace pertev::test;

namespace {

/// Fields by line, quotes taken off.
std::vector<std::vector<std::string>> parse_csv(const std::string& csv) {
    std::vector<std::vector<std::string>> lines(1, std::vector<std::string>(1));
    bool quoted = false;
    for (std::size_t i = 0; i < csv.size(); ++i) {
        const char c = csv[i];
        std::string& field = lines.back().back();
        if (c == '"' && quoted && i + 1 < csv.size() && csv[i + 1] == '"') {
            field += c, ++i;
        } else if (c == '"') {
            quoted = !quoted;
        } else if (!quoted && c == ',') {
            lines.back().emplace_back();
        } else if (!quoted && c == '\n') {
            lines.emplace_back(1);
        } else {
            field += c;
        }
    }
    lines.pop_back(); // what follows the last line feed
    return lines;
}

std::string field(const std::vector<std::vector<std::string>>& csv, std::size_t line, const std::string& name) {
    const auto at = std::ranges::find(csv[0], name);
    REQUIRE_MESSAGE(at != csv[0].end(), name);
    return csv[line][static_cast<std::size_t>(at - csv[0].begin())];
}

} // namespace

TEST_CASE("a frame of depth d is the sets of depths 1 to d, and needs all of them") {
    LabReport report = small_report();
    const CombinationFigures& c = report.combinations[0];
    CHECK(frame_seconds(report, c, 1).value() == doctest::Approx(2));
    CHECK(frame_seconds(report, c, 2).value() == doctest::Approx(2.5));
    CHECK(!frame_seconds(report, c, 3));
    CHECK(!frame_seconds(report, report.combinations[1], 1));
    CHECK(frame_rays(report, 2) == 10'000'000);
    CHECK(largest_depth(report) == 2);
    CHECK(mrays(report, c.runs[0]) == doctest::Approx(4));
}

TEST_CASE("every line of the CSV has as many fields as its head, and quotes come back") {
    const auto csv = parse_csv(csv_of(small_report()));
    REQUIRE(csv.size() == 1 + 3 + 1);
    for (const auto& line : csv) CHECK(line.size() == csv[0].size());
    CHECK(field(csv, 1, "scene") == "a \"quoted\", scene <&>");
    CHECK(field(csv, 4, "refused") == "no <planes>, none");
    for (const auto& [name, value] : {std::pair{"threads", "7"},
                                      {"width", "4"},
                                      {"height", "2"},
                                      {"commit", "1.0 abc"},
                                      {"warm_ups", "1"},
                                      {"interrupted", "0"}}) {
        CAPTURE(name);
        CHECK(field(csv, 1, name) == value);
    }
}

TEST_CASE("in the CSV a 0 is a figure, and what was not measured is empty") {
    LabReport report = small_report();
    report.combinations[0].registers = 40, report.combinations[0].local_bytes = 0;
    report.combinations[0].runs[1].is_copy = true;
    report.combinations[1].wrong = true;
    const auto csv = parse_csv(csv_of(report));
    CHECK(field(csv, 1, "triangles_per_ray") == "0.000"); // measured: none
    CHECK(field(csv, 2, "triangles_per_ray").empty());
    CHECK(field(csv, 1, "different_rays") == "0");
    CHECK(field(csv, 1, "node_lanes").empty());
    CHECK(field(csv, 1, "triangle_sectors").empty());
    CHECK(field(csv, 1, "registers") == "40");
    CHECK(field(csv, 1, "local_bytes") == "0");
    CHECK(field(csv, 2, "registers").empty()); // any hit: another kernel
    CHECK(field(csv, 1, "wrong") == "0");
    CHECK(field(csv, 4, "wrong") == "1");
    CHECK(field(csv, 1, "is_copy") == "0");
    CHECK(field(csv, 2, "is_copy") == "1");
    CHECK(field(csv, 2, "frames_per_second").empty()); // shadow rays are no frame
    CHECK(field(csv, 2, "frame_depth").empty());
    CHECK(field(csv, 3, "frame_depth") == "2");
    CHECK(field(csv, 3, "frames_per_second") == "0.4");
    for (const char* name : {"nodes", "leaf_triangles", "build_seconds", "sah_cost", "depth", "bytes"}) {
        CAPTURE(name);
        CHECK(!field(csv, 1, name).empty());
        CHECK(field(csv, 4, name).empty()); // it never came to its structure
    }
    CHECK(field(csv, 4, "structure") == "binned");
}

TEST_CASE("the price of exactness stands with the exact combination alone") {
    LabReport report = small_report();
    report.combinations.push_back(figures({.options = kFastTests}, {timed(0, 1)}));
    report.combinations.back().runs[0].different = 17;
    const auto csv = parse_csv(csv_of(report));
    CHECK(field(csv, 1, "price_of_exactness") == "2.0000");
    CHECK(field(csv, 2, "price_of_exactness").empty());
    CHECK(field(csv, 5, "price_of_exactness").empty());
    CHECK(field(csv, 5, "different_rays") == "17");
    CHECK(has(json_of(report), R"("price_of_exactness":2})"));
    CHECK(has(html_ratios(report), "The price of exactness"));
    CHECK(has(html_ratios(report), "<td>2.000</td><td></td><td></td>"));
    CHECK(has(html_figures(report), "<td>17</td>"));
}

TEST_CASE("JSON has the figures and null for what is not there") {
    LabReport report = small_report();
    report.structures[0].sah_cost = 1.0 / 0.0;
    const std::string json = json_of(report);
    CHECK(has(json, R"("frame_seconds":[2,2.5])"));
    CHECK(has(json, R"("frame_seconds":[null,null])"));
    CHECK(has(json, R"("sah_cost":null)"));
    CHECK(count(json, R"("registers":null,"local_bytes":null,"occupancy":null)") == 2);
    CHECK(count(json, R"("node_lanes":null)") == 3);
    CHECK(has(json, R"("nodes_per_ray":10,"triangles_per_ray":0,)"));
    CHECK(has(json, R"("structure":"binned","structure_kind":"binned")"));
    CHECK(has(json, R"("structure":null,"structure_kind":"binned","walk":"kd")"));
    CHECK(has(json, R"("threads":7,"camera":"at <1, 2, 3>")"));
    CHECK(count(json, "{") == count(json, "}"));
    CHECK(count(json, "[") == count(json, "]"));
}

TEST_CASE("short times and slow frames keep two digits") {
    CHECK(fixed_text(1.234, 2) == "1.23");
    CHECK(fixed_text(0.1, 2) == "0.10");
    CHECK(fixed_text(0.034, 2) == "0.034");
    CHECK(fixed_text(0.000039, 3) == "3.9e-05");
    CHECK(fixed_text(0, 5) == "0.00000");
    CHECK(uncertain_text(0.0036712, 0.000214) == "0.00367 ± 0.00021");
    CHECK(uncertain_text(0.5412, 0.4961) == "0.54 ± 0.50");
    CHECK(uncertain_text(0.5412, 0.0996) == "0.54 ± 0.10"); // which 0.0996 is in two digits
    CHECK(uncertain_text(12.345, 3.21) == "12.3 ± 3.2");
    CHECK(uncertain_text(1234.4, 32.1) == "1234 ± 32");
    CHECK(uncertain_text(12344, 321) == "12340 ± 320");
    CHECK(uncertain_text(0.00001234, 0.00000056) == "1.234e-05 ± 5.6e-07");
    CHECK(uncertain_text(0.0000001, 0.00000056) == "1.0e-07 ± 5.6e-07");
    CHECK(uncertain_text(0.25, 0) == "0.25 ± 0");
    CHECK(uncertain_text(0.107986807, 4.2e-17) == "0.108 ± 0"); // a sum's rounding
    LabReport report = small_report();
    report.structures[0].build_s = 3.9e-5;
    report.combinations[0].structure = 0;
    CHECK(field(parse_csv(csv_of(report)), 1, "build_seconds") == "3.9e-05");
    CHECK(has(html_structures(report), "<td>3.9e-05</td>"));
    CHECK(has(text_of(report), "3.9e-05"));
}

TEST_CASE("a tree without inner nodes has a cost and a depth, an array of triangles has neither") {
    LabReport report = small_report();
    report.structures[0].nodes = 0, report.structures[0].sah_cost = 1, report.structures[0].depth = 0;
    CHECK(has(html_structures(report), "<td>1.00</td><td>0</td></tr>"));
    CHECK(has(json_of(report), R"("sah_cost":1,"depth":0})"));
    CHECK(field(parse_csv(csv_of(report)), 1, "sah_cost") == "1.000");
    report.structures[0].sah_cost.reset(), report.structures[0].depth.reset();
    CHECK(has(html_structures(report), "<td></td><td></td></tr>"));
    CHECK(has(json_of(report), R"("sah_cost":null,"depth":null})"));
    CHECK(field(parse_csv(csv_of(report)), 1, "depth").empty());
}

TEST_CASE("the spread of a figure is that of its slowest and its fastest run; no ray that differs is a 0") {
    const std::string html = html_figures(small_report());
    CHECK(has(html, "<th>Mrays/s</th><th>slowest</th><th>fastest</th>"));
    CHECK(has(html, "<td>primary</td><td>4.00</td><td>2.00</td><td>8.00</td>"));
    CHECK(count(html, "<td>0</td></tr>") == 3);
    CHECK(has(html, "A ray of a packet counts the nodes that it takes part in"));
}

TEST_CASE("columns of text are as wide as their longest cell, counted in characters") {
    CHECK(align_columns({{"name", "a"}, {"longer name", "±1%"}, {"x"}}) == "name           a\nlonger name  ±1%\nx\n");
    CHECK(align_columns({}).empty());
}

TEST_CASE("the terminal's table places figures by set, gaps included, and spread beside the median") {
    LabReport report = small_report();
    // Interrupted: its diffuse rays are there and its shadow rays are not.
    const Combination gap = {
        .structure = StructureKind::EqualCounts, .walk = WalkKind::RestartTrail, .options = kNoRta};
    report.combinations.push_back(figures(gap, {timed(0, 4), timed(2, 2)}));
    report.interrupted = true;
    const std::string text = text_of(report);
    const std::string table = text.substr(text.find("million rays"));
    CHECK(has(line_with(table, "binned while-while"), "4.00 [2.00, 8.00] (10.0 + 0.0)"));
    const std::string head = line_with(table, "primary"), row = line_with(table, name_of(gap));
    CHECK(head.ends_with("diffuse1"));
    CHECK(row.ends_with("1.00 [1.00, 1.00]"));
    CHECK(head.size() == row.size());                 // below it, not below shadow
    CHECK(has(row, "2.00 [2.00, 2.00]            ")); // nothing below shadow
    CHECK(count(row, "[") == 2);
    const std::string frames = text.substr(text.find("frames a second by depth"));
    CHECK(has(line_with(frames, "binned while-while"), "0.50     0.40"));
    CHECK(text.ends_with("interrupted: this is what had been measured\n"));
    CHECK(!has(text, "lanes"));
    CHECK(!has(text, "occupancy"));
}

TEST_CASE("what warps make of it is shown where it was measured") {
    LabReport report = small_report();
    report.combinations[0].registers = 48, report.combinations[0].occupancy = 0.625;
    RunFigures& run = report.combinations[0].runs[1];
    run.node_lanes = 21.5, run.triangle_lanes = 7.25, run.node_sectors = 16.0, run.triangle_sectors = 30.5;
    const std::string text = text_of(report), html = html_figures(report);
    CHECK(has(text, "shadow lanes"));
    CHECK(!has(text, "primary lanes"));
    CHECK(has(text, "21.5 / 7.2"));
    CHECK(has(text, "16.0 / 30.5"));
    CHECK(has(text, "62%"));
    CHECK(has(html, "21.5"));
    CHECK(has(html, "16 (neighbours, perfect) to 32"));
    CHECK(has(html, "not measured"));
    const std::string any_hit = line_with(html, "<td>shadow</td>"), closest = line_with(html, "<td>primary</td>");
    CHECK(has(closest, "<td>48</td>"));
    CHECK(has(closest, "<td>62 %</td>"));
    CHECK(!has(any_hit, "<td>48</td>")); // they are of the closest-hit kernel
    CHECK(!has(any_hit, "62 %"));
    CHECK(!has(html_figures(small_report()), "occupancy"));
}

TEST_CASE("combinations that were checked and not timed have no speed") {
    LabReport report = small_report();
    report.runs = 0;
    for (RunFigures& run : report.combinations[0].runs) run = {.set = run.set};
    const auto csv = parse_csv(csv_of(report));
    for (const char* name : {"median_seconds", "least_seconds", "rays_per_second", "frames_per_second"}) {
        CHECK(field(csv, 1, name).empty());
    }
    CHECK(field(csv, 1, "different_rays") == "0");
    CHECK(has(json_of(report), R"("rays_per_second":null)"));
    CHECK(!has(html_of(report), "<svg"));
    CHECK(has(html_of(report), "checked alone"));
    CHECK(has(line_with(text_of(report), name_of(Combination{})), "right"));
}
