#include <doctest/doctest.h>

#include <algorithm>

#include "lab/thesis.h"
#include "tests/support/small_lab_report.h"

using namespace pertev;
using namespace pertev::test;

namespace {

/// A report of both scenes and three depths in which everything was measured.
ThesisReport full_thesis(const std::string& device) {
    ThesisReport thesis;
    for (const char* scene : {"cornell-box", "sibenik <hall>"}) {
        LabReport report;
        report.scene = scene, report.device = device;
        report.triangles = 36, report.width = 1024, report.height = 768, report.runs = 20, report.warm_ups = 3;
        report.sets = {{.name = "primary", .depth = 1, .rays = 1'000'000},
                       {.name = "diffuse1", .depth = 2, .rays = 500'000},
                       {.name = "diffuse2", .depth = 3, .rays = 250'000}};
        for (const ThesisVariant& v : thesis_variants(device != "CPU")) {
            CombinationFigures c = {.combination = v.combination, .name = name_of(v.combination)};
            for (uint32_t set = 0; set < 3; ++set) {
                c.runs.push_back({.set = set, .median_s = 0.01, .min_s = 0.01, .largest_s = 0.01});
                if (!v.combination.options.is_exact()) c.runs.back().different = 40 + set;
            }
            report.combinations.push_back(c);
        }
        thesis.scenes.push_back(report);
    }
    return thesis;
}

CombinationFigures& variant(LabReport& report, const std::string& name, bool is_cuda) {
    for (const ThesisVariant& v : thesis_variants(is_cuda)) {
        if (v.name != name) continue;
        const auto at = std::ranges::find(report.combinations, name_of(v.combination), &CombinationFigures::name);
        REQUIRE(at != report.combinations.end());
        return *at;
    }
    FAIL("no such variant");
    return report.combinations.front();
}

} // namespace

TEST_CASE("the thesis's variants are different combinations that are valid on their device") {
    for (const bool is_cuda : {false, true}) {
        std::vector<std::string> names;
        for (const ThesisVariant& v : thesis_variants(is_cuda)) {
            CAPTURE(v.name);
            CHECK(!why_not(v.combination, is_cuda));
            names.push_back(name_of(v.combination));
        }
        std::ranges::sort(names);
        CHECK(std::ranges::adjacent_find(names) == names.end());
        CHECK(names.size() == (is_cuda ? 7 : 5));
    }
}

TEST_CASE("the thesis has a row per scene, variant and depth, from which the page draws its tables and figures") {
    const Measurement m = measurement_of(full_thesis("NVIDIA H200"));
    const ResultTable& frames = m.table("frames");
    REQUIRE(frames.rows.size() == 2 * 7 * 3);
    CHECK(frames.at(40, "scene") == "sibenik <hall>");
    CHECK(frames.at(40, "number") == 2);
    CHECK(frames.at(40, "variant") == "A");
    CHECK(frames.at(40, "depth") == 2);
    CHECK(frames.at(40, "frames_per_second") == 50.0);
    CHECK(frames.at(40, "seconds") == 0.02);
    CHECK(frames.at(40, "mrays") == 75.0); // 1.5 million rays in 0.02 s
    CHECK(measurement_of(full_thesis("CPU")).table("frames").rows.size() == 2 * 5 * 3);
    CHECK(m.table("scenes").rows.size() == 2);
    const std::string text = text_of(full_thesis("CPU"));
    CHECK(has(text, "the same tree: binned"));
    CHECK(has(text, "plain while-while"));
    CHECK(!has(text, "WRONG"));
}

TEST_CASE("missing parts of the thesis are named with the reason in its notes and the terminal") {
    ThesisReport thesis = full_thesis("CPU");
    thesis.scenes.pop_back();
    thesis.lacking = {"figure 6.8: <no file>", "figure-3.6: out of memory"};
    const std::string text = text_of(thesis);
    const Measurement m = measurement_of(thesis);
    CHECK(has(text, "Not made: figure 6.8: <no file>\n"));
    CHECK(m.notes[1] == "Not made: figure-3.6: out of memory");
    CHECK(m.table("lacking").at(1, "what") == "figure-3.6: out of memory");
}

TEST_CASE("the thesis's pictures are grouped by figure, with their commands") {
    ThesisReport thesis = full_thesis("CPU");
    ThesisPicture rendered = {.name = "figure-3.8",
                              .place = "Figure 3.8",
                              .title = "a mirror",
                              .shows = "A mirror.",
                              .integrator = "path",
                              .command = "pertev render x",
                              .image = {1, 1, {1, 2, 3, 255}}};
    rendered.stats.samples = 32, rendered.stats.render_seconds = 2;
    thesis.pictures = {
        rendered,
        {.name = "figure-4.1a", .place = "Figure 4.1", .title = "points", .shows = "Points.", .svg = "<svg/>"}};
    const Measurement m = measurement_of(thesis);
    REQUIRE(m.pictures.size() == 2);
    CHECK(m.pictures[0].group == "Figure 3.8: a mirror");
    CHECK(m.pictures[0].caption == "A mirror. Integrator path, 32 samples per pixel in 2 s. Made by: pertev render x");
    CHECK(m.pictures[1].caption == "Points. Made by the laboratory alone.");
    const ResultTable& table = m.table("pictures");
    CHECK(table.at(0, "file") == "figure-3.8.png");
    CHECK(table.at(0, "frames_per_second") == 16.0);
    CHECK(!table.at(0, "solve_seconds").is_there());
    CHECK(table.at(1, "file") == "figure-4.1a.svg");
    CHECK(!table.at(1, "samples").is_there());
    CHECK(!table.at(1, "width").is_there());
}

TEST_CASE("the number of differing rays of A is reported") {
    const std::string text = text_of(full_thesis("NVIDIA H200"));
    CHECK(has(text, "cornell-box, A: 40 of 1000000 primary rays differ"));
    CHECK(has(text, "sibenik <hall>, A: 42 of 250000 diffuse2 rays differ"));
    CHECK(count(text, "rays differ from") == 2 * 3);
}

TEST_CASE("wrong, refused and missing variants are named with the reason") {
    ThesisReport thesis = full_thesis("NVIDIA H200");
    CombinationFigures& wrong = variant(thesis.scenes[0], "PSWW", true);
    wrong.wrong = true, wrong.refused = "WRONG: 3 of 9 rays differ", wrong.runs.clear();
    CombinationFigures& refused = variant(thesis.scenes[1], "PPacket", true);
    refused.refused = "shared <meshes>", refused.runs.clear();
    std::erase_if(thesis.scenes[1].combinations,
                  [](const CombinationFigures& c) { return !c.combination.options.is_exact(); });
    const std::string text = text_of(thesis);
    CHECK(has(text, "cornell-box: WRONG " + name_of(wrong.combination) + ": WRONG: 3 of 9 rays differ\n"));
    CHECK(has(text, "sibenik <hall>: Not run: shared <meshes>: " + name_of(refused.combination) + "\n"));
    CHECK(measurement_of(thesis).table("frames").rows.size() == (2 * 7 - 3) * 3);
}

TEST_CASE("an interrupted chapter is marked and lists its missing parts") {
    ThesisReport thesis = full_thesis("CPU");
    thesis.scenes.pop_back();
    LabReport& report = thesis.scenes[0];
    report.interrupted = true;
    variant(report, "SWW-R", false).runs.pop_back();
    CombinationFigures& late = variant(report, "A", false);
    late.runs.clear(), late.refused = "interrupted before it was measured";
    const std::string text = text_of(thesis);
    CHECK(has(text, "cornell-box: interrupted;"));
    CHECK(has(text, "cornell-box: Not run: interrupted before it was measured: " + name_of(late.combination)));
    CHECK(measurement_of(thesis).table("frames").rows.size() == 2 + 3 * 3);
    CHECK(has(text_of(ThesisReport{}), "Nothing was measured."));
    CHECK(measurement_of(ThesisReport{}).table("frames").rows.empty());
}
