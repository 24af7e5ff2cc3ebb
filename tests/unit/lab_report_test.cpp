#include <doctest/doctest.h>

#include "lab/lab_tables.h"
#include "tests/support/small_lab_report.h"

using namespace pertev;
using namespace pertev::test;

namespace {

ResultTable runs_of(const LabReport& report) { return measurement_of(report).table("runs"); }

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
    CHECK(mrays(report, c.runs[0], c.runs[0].median_s) == doctest::Approx(4));
}

TEST_CASE("the laboratory's table of runs has each figure and empty cells where nothing was measured") {
    LabReport report = small_report();
    report.combinations[0].registers = 40, report.combinations[0].local_bytes = 0;
    report.combinations[0].runs[1].is_copy = true;
    report.combinations[1].wrong = true;
    const ResultTable runs = runs_of(report);
    REQUIRE(runs.rows.size() == 3 + 1);
    CHECK(runs.at(0, "mrays") == 4.0);
    CHECK(runs.at(0, "mrays_slowest") == 2.0);
    CHECK(runs.at(0, "mrays_fastest") == 8.0);
    CHECK(runs.at(0, "triangles_per_ray") == 0.0); // nothing was measured
    CHECK(!runs.at(1, "triangles_per_ray").is_there());
    CHECK(runs.at(0, "different_rays") == 0);
    CHECK(!runs.at(0, "node_lanes").is_there());
    CHECK(runs.at(0, "registers") == 40);
    CHECK(runs.at(0, "local_bytes") == 0);
    CHECK(!runs.at(1, "registers").is_there()); // any-hit rays use another kernel
    CHECK(runs.at(3, "wrong") == true);
    CHECK(runs.at(3, "refused") == "no <planes>, none");
    CHECK(runs.at(1, "is_copy") == true);
    CHECK(!runs.at(1, "frame_depth").is_there()); // a frame has no shadow rays
    CHECK(runs.at(2, "frame_depth") == 2);
    CHECK(runs.at(2, "frames_per_second") == 0.4);
    CHECK(runs.at(2, "frame_mrays") == 4.0);
    for (const char* name : {"nodes", "leaf_triangles", "build_seconds", "sah_cost", "depth", "bytes"}) {
        CAPTURE(name);
        CHECK(runs.at(0, name).is_there());
        CHECK(!runs.at(3, name).is_there()); // its structure was never measured
    }
    CHECK(runs.at(3, "structure") == "binned");
}

TEST_CASE("the laboratory's CSV has the scene's columns before those of its runs") {
    const std::string csv = csv_of(measurement_of(small_report()), "runs");
    CHECK(
        csv.starts_with("program,date,processor,threads,device,scene,scene_triangles,instances,camera,width,height,"));
    CHECK(count(csv, "\n") == 1 + 3 + 1);
    CHECK(has(
        csv,
        ",CPU,\"a \"\"quoted\"\", scene <&>\",1000,0,\"at <1, 2, 3>\",4,2,1,2,20,1,0,binned while-while rta near,"));
    CHECK(has(csv, "\"no <planes>, none\""));
}

TEST_CASE("the laboratory's other tables describe its scene, ray sets and structures") {
    LabReport report = small_report();
    report.structures.push_back({.name = "octree", .failed = "too <large>"});
    const Measurement m = measurement_of(report);
    CHECK(m.kind == "lab");
    CHECK(m.table("scene").at(0, "camera") == "at <1, 2, 3>");
    CHECK(m.table("scene").at(0, "last_depth") == 2);
    const ResultTable& sets = m.table("sets");
    CHECK(sets.at(0, "brute_force_rays") == 2200);
    CHECK(sets.at(0, "hit_share") == 0.5);
    CHECK(!sets.at(1, "depth").is_there());
    const ResultTable& structures = m.table("structures");
    CHECK(structures.at(0, "bytes_per_triangle") == 64.0);
    CHECK(structures.at(0, "depth") == 9);
    CHECK(structures.at(1, "failed") == "too <large>");
    CHECK(!structures.at(1, "nodes").is_there());
    CHECK(has(text_of(report), "octree: too <large>"));
}

TEST_CASE("an incorrect combination is named first and has no figures") {
    LabReport report = small_report();
    CombinationFigures& c = report.combinations[0];
    c.wrong = true, c.refused = "WRONG: 3 of 9 <primary> rays differ", c.runs.clear();
    CHECK(has(text_of(report), "\nWRONG binned while-while rta near: WRONG: 3 of 9"));
    const Measurement m = measurement_of(report);
    CHECK(m.notes.front() == "WRONG binned while-while rta near: WRONG: 3 of 9 <primary> rays differ");
    CHECK(std::ranges::count_if(m.notes, [](const std::string& note) { return has(note, "3 of 9"); }) == 1);
    CHECK(!m.table("runs").at(0, "mrays").is_there());
    CHECK(m.table("runs").at(0, "wrong") == true);
}

TEST_CASE("notes list missing results and skipped combinations, grouped by reason") {
    LabReport report = small_report();
    report.notes = {"shadow: <none>"};
    report.combinations.push_back({.name = "first", .refused = "other"});
    report.combinations.push_back({.name = "second", .refused = "no <planes>, none"});
    const std::vector<std::string> notes = measurement_of(report).notes;
    CHECK(notes == std::vector<std::string>{"shadow: <none>", "Not run: no <planes>, none: binned kd rta near, second",
                                            "Not run: other: first"});
    CHECK(has(text_of(report), "\nshadow: <none>\n"));
}

TEST_CASE("heat maps of a report share one scale") {
    LabReport report = small_report();
    report.heat_maps.push_back({"b", 1e6, 1, 1, {1}, {2}});
    const Measurement m = measurement_of(report);
    REQUIRE(m.pictures.size() == 4);
    CHECK(m.pictures[0].title == name_of(Combination{}));
    CHECK(m.pictures[0].group != m.pictures[1].group);
    CHECK(m.pictures[2].group == m.pictures[0].group);
    CHECK(m.pictures[2].caption == m.pictures[0].caption); // equal ends of the scale
}

TEST_CASE("the terminal's table has a column for each set, gaps included, and the fastest combination first") {
    LabReport report = small_report();
    // An interrupted combination has figures of diffuse rays but not of shadow rays.
    const Combination gap = {
        .structure = StructureKind::EqualCounts, .traversal = TraversalKind::RestartTrail, .options = kNoRta};
    report.combinations.push_back(figures(gap, {timed(0, 1), timed(2, 2)}));
    report.interrupted = true;
    const std::string text = text_of(report), table = text.substr(text.find("million rays"));
    CHECK(table.find(name_of(gap)) < table.find("binned while-while"));
    CHECK(line_with(table, "binned while-while").ends_with("4.00    4.00      4.00"));
    CHECK(line_with(table, name_of(gap)).ends_with("8.00       -      1.00"));
    const std::string frames = text.substr(text.find("frames per second by depth"));
    CHECK(has(line_with(frames, "binned while-while"), "0.50  0.40"));
    CHECK(text.ends_with("interrupted: the results are incomplete\n"));
}

TEST_CASE("combinations that were checked but not timed have no speed") {
    LabReport report = small_report();
    report.runs = 0;
    for (RunFigures& run : report.combinations[0].runs) run = {.set = run.set};
    const ResultTable runs = runs_of(report);
    for (const char* name : {"median_seconds", "least_seconds", "rays_per_second", "mrays", "frames_per_second"}) {
        CHECK(!runs.at(0, name).is_there());
    }
    CHECK(runs.at(0, "different_rays") == 0);
}
