#include <doctest/doctest.h>

#include "lab/html_plots.h"
#include "lab/html_tables.h"
#include "lab/write_html.h"
#include "lab/write_tables.h"
#include "tests/support/small_lab_report.h"

using namespace pertev;
using namespace pertev::test;

TEST_CASE("a wrong combination is named first and has no figures anywhere") {
    LabReport report = small_report();
    CombinationFigures& c = report.combinations[0];
    c.wrong = true, c.refused = "WRONG: 3 of 9 <primary> rays differ", c.runs.clear();
    CHECK(text_of(report).starts_with("WRONG binned while-while rta near: 3 of 9"));
    const std::string html = html_of(report);
    const std::size_t named = html.find("binned while-while rta near: WRONG: 3 of 9 &lt;primary&gt;");
    REQUIRE(named != std::string::npos);
    CHECK(named < html.find("<ul>"));
    CHECK(named < html.find("<h2>"));
    CHECK(has(html, ".wrong{color:#b00}"));
    CHECK(count(html, "3 of 9") == 1); // not among those not run
    CHECK(!has(html, "<svg"));
    CHECK(has(json_of(report), R"("wrong":true)"));
    CHECK(html_wrong(small_report()).empty());
}

TEST_CASE("the HTML report stands alone, escapes names, and shows what there is") {
    const std::string html = html_of(small_report());
    CHECK(html.starts_with("<!DOCTYPE html>"));
    CHECK(count(html, "http://") == count(html, "http://www.w3.org/2000/svg")); // nothing is fetched
    CHECK(!has(html, "https://"));
    CHECK(!has(html, "<script"));
    CHECK(has(html, "scene &lt;&amp;&gt;"));
    CHECK(has(html, "no &lt;planes&gt;"));
    CHECK(has(html, "Camera: at &lt;1, 2, 3&gt;"));
    CHECK(has(html, "Threads of the CPU: 7"));
    CHECK(has(html, "paths of depths 1 to 2"));
    CHECK(has(html, "<td>primary</td><td>closest hit</td><td>1</td><td>8000000</td><td>50.0 %</td><td>2200</td>"));
    CHECK(has(html, "<td>shadow</td><td>any hit</td><td></td>"));
    CHECK(has(html, "a kd-tree one plane"));
    CHECK(count(html, "<svg") == 3 + 2); // a bar chart a set, two curves
    CHECK(count(html, "data:image/png;base64,iVBORw0KGgo") == 2);
    check_tags(html);
    check_tags(html_of(LabReport{}));
}

TEST_CASE("a structure that failed spans the rest of its row") {
    LabReport report = small_report();
    report.structures.push_back({.name = "octree", .failed = "too <large>"});
    const std::string html = html_structures(report);
    CHECK(has(html, "<td colspan=\"7\">too &lt;large&gt;</td>"));
    CHECK(count(html, "<th>") == 8);
    CHECK(has(text_of(report), "octree: too <large>"));
}

TEST_CASE("the matrix has structures down and walks across, with all switches on and one ray a thread") {
    LabReport report = small_report();
    report.combinations.push_back(
        figures({.structure = StructureKind::SpatialSplits, .walk = WalkKind::Wide8}, {timed(0, 1)}));
    report.combinations.push_back(figures({.options = kNoRta}, {timed(0, 0.001)}));
    report.combinations.push_back(figures({.options = kFastTests}, {timed(0, 0.001)}));
    report.combinations.push_back(figures({.distribution = Distribution::Persistent}, {timed(0, 0.001)}));
    const std::string html = html_matrices(report);
    CHECK(has(html, "<th>structure</th><th>while-while</th><th>wide8</th>"));
    CHECK(has(html, "<td>binned</td><td>4.00</td><td></td>"));
    CHECK(has(html, "<td>sbvh</td><td></td><td>8.00</td>"));
    CHECK(!has(html, "8000")); // the others are not in it
    CHECK(count(html, "<table>") == 3);
}

TEST_CASE("ratios are of pairs that differ in one switch; copies and refused twins are left out") {
    LabReport report = small_report();
    using enum Distribution;
    report.combinations.push_back(figures({.options = kNoRta}, {timed(0, 3), timed(1, 1), timed(2, 0.5)}));
    report.combinations.back().runs[1].is_copy = true;
    report.combinations.push_back(figures({.options = {.near_first = false}}, {timed(0, 5)}));
    report.combinations.push_back(figures({.distribution = Persistent}, {timed(0, 1)}));
    report.combinations.push_back(figures({.distribution = DynamicFetch}, {timed(2, 0.4)}));
    // Skip links know no order.
    const Combination skip = {.walk = WalkKind::SkipLinks},
                      skip_no_rta = {.walk = WalkKind::SkipLinks, .options = kNoRta};
    Combination refused = skip_no_rta;
    refused.options.near_first = false;
    report.combinations.push_back({.combination = refused, .name = name_of(refused), .refused = "no order"});
    report.combinations.push_back(figures(skip_no_rta, {timed(0, 4)}));
    report.combinations.push_back(figures(skip, {timed(0, 1)}));
    const std::string html = html_ratios(report), name = name_of(Combination{});
    CHECK(has(html, "<td>" + name + "</td><td>1.500</td><td></td><td>1.000</td>"));
    CHECK(has(html, "<td>" + name + "</td><td>2.500</td><td></td><td></td>"));
    CHECK(has(html, "<td>" + name + " persistent</td><td>2.000</td>"));
    CHECK(has(html, "<td>" + name + " dynamic-fetch</td><td></td><td></td><td>1.250</td>"));
    CHECK(has(html, "<td>" + name_of(skip) + "</td><td>4.000</td>"));
    CHECK(count(html, "<h3>") == 4); // none of fast tests
    CHECK(count(html, "<td>" + name_of(skip)) == 1);
    CHECK(has(html_figures(report), "<td>shadow, same walk</td>"));
    CHECK(count(html_bars(report), "<title>" + name_of(Combination{.options = kNoRta}) + ": ") == 2); // of 3 sets
    check_tags(html_of(report));
}

TEST_CASE("bars are the thirty fastest, coloured by family, fast tests hollow") {
    LabReport report = small_report();
    report.combinations.clear();
    for (const StructureKind structure : kValuesOf<StructureKind>) {
        for (const WalkKind walk : {WalkKind::WhileWhile, WalkKind::SkipLinks, WalkKind::Wide4, WalkKind::Packet}) {
            const double seconds = 1 + static_cast<double>(report.combinations.size());
            report.combinations.push_back(figures({.structure = structure, .walk = walk}, {timed(0, seconds)}));
        }
    }
    const std::string html = html_bars(report);
    CHECK(has(html, "The 30 fastest of 52;"));
    CHECK(has(html, "binary, stackless"));
    CHECK(!has(html, "kd-tree and octree"));
    CHECK(!has(html, "hollow"));
    CHECK(count(html, "<rect") == 30 + 4); // and the legend
    CHECK(count(html, "stroke-dasharray") == 0);
    report.combinations.push_back(figures({.options = kFastTests}, {timed(0, 0.5), timed(2, 0.01)}));
    const std::string hollow = html_bars(report);
    CHECK(has(hollow, "hollow: fast tests"));
    CHECK(count(hollow, "stroke-dasharray") == 2 + 2); // two sets, a bar and a legend each
}

TEST_CASE("curves leave fast tests and copies out") {
    LabReport report = small_report();
    report.combinations.push_back(figures({.options = kFastTests}, {timed(0, 0.1), timed(2, 0.1)}));
    report.combinations.push_back(figures({.options = kNoRta}, {timed(0, 0.1), timed(2, 0.1)}));
    report.combinations.back().runs[0].is_copy = true;
    const std::string html = html_curves(report);
    CHECK(count(html, "<polyline") == 2);
    CHECK(!has(html, "fast-tests"));
    CHECK(!has(html, "no-rta"));
}

TEST_CASE("the HTML has the heat maps that the report kept, and says of how many these are the fastest") {
    LabReport report = small_report();
    for (const char* name : {"b", "c"}) report.heat_map_names.emplace_back(name);
    report.heat_maps.push_back({"b", 1e6, 1, 1, {1}, {2}});
    const std::string html = html_heat_maps(report);
    CHECK(count(html, "<img") == 4);
    CHECK(has(html, "those of the 2 that were fastest at camera rays, of 3; all are PNG files"));
    CHECK(html.find(name_of(Combination{}) + ": nodes") < html.find("b: nodes"));
    CHECK(!has(html_heat_maps(small_report()), "beside this report"));
}

TEST_CASE("what was asked for and is not there is told in every report that people read, and in JSON") {
    LabReport report = small_report();
    report.notes = {"shadow: <none>"};
    CHECK(has(html_of(report), "<li>shadow: &lt;none&gt;</li>"));
    CHECK(has(text_of(report), "\nshadow: <none>\n"));
    CHECK(has(json_of(report), R"("notes":["shadow: <none>"])"));
    CHECK(has(json_of(small_report()), R"("notes":[])"));
}

TEST_CASE("what was not run is grouped by reason") {
    LabReport report = small_report();
    report.combinations.push_back({.name = "first", .refused = "other"});
    report.combinations.push_back({.name = "second", .refused = "no <planes>, none"});
    const std::string html = html_not_run(report);
    CHECK(count(html, "<li>") == 2);
    CHECK(has(html, "<strong>no &lt;planes&gt;, none</strong>: binned kd rta near, second</li>"));
}
