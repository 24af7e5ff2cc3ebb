#include <doctest/doctest.h>

#include <algorithm>
#include <sstream>

#include "lab/thesis.h"
#include "tests/support/small_lab_report.h"

using namespace pertev;
using namespace pertev::test;

namespace {

/// Both scenes, three depths, everything measured.
ThesisReport full_thesis(const std::string& device) {
    ThesisReport thesis;
    for (const char* scene : {"cornell-box", "sibenik <hall>"}) {
        LabReport report;
        report.scene = scene, report.device = device, report.threads = 3;
        report.triangles = 36, report.width = 1024, report.height = 768, report.runs = 20, report.warm_ups = 3;
        report.sets = {{.name = "primary", .depth = 1, .rays = 1'000'000},
                       {.name = "diffuse1", .depth = 2, .rays = 500'000},
                       {.name = "diffuse2", .depth = 3, .rays = 250'000}};
        for (const ThesisVariant& v : thesis_variants(device != "CPU")) {
            CombinationFigures c = {.combination = v.combination, .name = name_of(v.combination)};
            for (uint32_t set = 0; set < 3; ++set) {
                c.runs.push_back({.set = set, .median_s = 0.01, .least_s = 0.01, .largest_s = 0.01});
                if (!v.combination.options.is_exact()) c.runs.back().different = 40 + set;
            }
            report.combinations.push_back(c);
        }
        thesis.scenes.push_back(report);
        const Rgba8Image image = {1, 1, {1, 2, 3, 255}};
        thesis.local.push_back({std::string(scene) + ", local", image});
        thesis.global.push_back({std::string(scene) + ", global; cut short <after 3 passes>", image});
    }
    return thesis;
}

void check_page(const std::string& html) {
    check_tags(html);
    CHECK(count(html, "http") == count(html, "http://www.w3.org/2000/svg"));
}

/// Of each table: its title, and its columns by the first word of each, every one once.
using Heads = std::vector<std::pair<std::string, std::string>>;

Heads heads_of(const std::string& text) {
    Heads heads;
    std::istringstream lines(text);
    for (std::string line, before; std::getline(lines, line); before = line) {
        if (!has(line, "frames/s")) continue;
        std::string columns;
        std::istringstream words(line);
        for (std::string word, last; words >> word;) {
            const bool is_unit = word == "frames/s" || word == "(s)" || word == "Mrays/s";
            if (!is_unit && word != last) columns += (columns.empty() ? "" : " ") + (last = word);
        }
        heads.emplace_back(before, columns);
    }
    return heads;
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

TEST_CASE("the thesis's variants are different combinations that make sense on their device") {
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

TEST_CASE("the thesis's tables are numbered as its captions and have a row a depth and the columns that these name") {
    const ThesisReport thesis = full_thesis("NVIDIA H200");
    const std::string html = html_of(thesis), text = text_of(thesis);
    const std::string box = "cornell-box", hall = "sibenik <hall>";
    CHECK(heads_of(text) ==
          Heads{{"Table 6.3: " + box + " with and without persistent threads", "depth SWW PSWW PPacket"},
                {"Table 6.4: " + hall + " with and without persistent threads", "depth SWW PSWW PPacket"},
                {"Table 6.5: " + hall + " with persistent threads and without RTA", "depth PSWW-R PPacket-R"},
                {"Table 6.6: both scenes at 1024x768 against Aila and Laine's kernel (A)",
                 "scene depth SWW PSWW PPacket A"},
                {"Figures 6.9 to 6.11 beside: " + box + " without RTA", "depth SWW-R PSWW-R PPacket-R"},
                {"Figures 6.9 to 6.11 beside: " + hall + " without RTA", "depth SWW-R"}});
    CHECK(count(html, "<table>") == 6);
    CHECK(count(html, "<tr>") == 6 + 7 * 3);                                // table 6.6 has both scenes
    CHECK(count(html, "<td>") == 3 * (2 * 7 + 5 + 2 * 10 + 7 + 3));         // two columns a variant
    CHECK(count(text, "50.00 (0.02000)") == 3 + 3 + 2 + 2 * 4 + 3 + 1);     // depth 2
    CHECK(count(html, "<td>75.00</td>") == count(text, "50.00 (0.02000)")); // 1.5 million rays in 0.02 s
    CHECK(count(text, "\nsibenik <hall>  ") == 3);                          // rows of table 6.6
    for (const std::string& said : {text, html}) CHECK(has(said, "the same tree: binned"));
    CHECK(!has(text, "WRONG"));
    CHECK(!has(html, "<td>-</td>"));
    check_page(html);
}

TEST_CASE("the thesis's tables say what a CPU has not got, and have every variant that was measured") {
    const ThesisReport thesis = full_thesis("CPU");
    const std::string html = html_of(thesis), text = text_of(thesis);
    const std::string none = "without persistent threads, which a CPU has not got";
    CHECK(heads_of(text) ==
          Heads{{"Table 6.3: cornell-box " + none, "depth SWW Packet"},
                {"Table 6.4: sibenik <hall> " + none, "depth SWW Packet"},
                {"Table 6.5: sibenik <hall> without RTA, and " + none, "depth SWW-R Packet-R"},
                {"Table 6.6: both scenes at 1024x768 against Aila and Laine's kernel (A)", "scene depth SWW Packet A"},
                {"Figures 6.9 to 6.11 beside: cornell-box without RTA", "depth SWW-R Packet-R"}});
    CHECK(count(html, "<table>") == 5);
    check_page(html);
}

TEST_CASE("what the thesis lacks is named on the page and in the terminal, with its reason") {
    ThesisReport thesis = full_thesis("CPU");
    thesis.scenes.pop_back();
    thesis.local.back().image = {}, thesis.global.back().image = {}; // which could not be made
    thesis.lacking = {"figure 6.8: <no file>", "figure-3.6: out of memory"};
    const std::string text = text_of(thesis), html = html_of(thesis);
    CHECK(test::has(text, "Not made: figure 6.8: <no file>\n"));
    CHECK(test::has(html, "<li class=\"wrong\">Not made: figure 6.8: &lt;no file&gt;</li>"));
    CHECK(test::has(html, "<li class=\"wrong\">Not made: figure-3.6: out of memory</li>"));
    CHECK_FALSE(test::has(text, "second scene was not measured")); // the reason says more
    CHECK(test::count(html, "<img") == 2);
    test::check_tags(html);
}

TEST_CASE("the thesis's figures of walks that a CPU has not got say so") {
    const std::string cpu = html_of(full_thesis("CPU")), cuda = html_of(full_thesis("NVIDIA H200"));
    CHECK(has(cpu, "Figure 6.9: RTA with persistent speculative while-while: needs a GPU."));
    CHECK(count(cpu, "<svg") == 2);
    CHECK(count(cuda, "<svg") == 3);
    CHECK(!has(cuda, "needs a GPU"));
    CHECK(has(cpu, "plain while-while"));
    CHECK(has(cuda, "Woop"));
    for (const char* title : {"Figure 6.7", "Figure 6.8"}) CHECK(has(cpu, title));
    CHECK(has(cpu, "cut short &lt;after 3 passes&gt;"));
    CHECK(count(cpu, "<img") == 4);
}

TEST_CASE("how many of A's rays differ is told") {
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
    const std::string text = text_of(thesis), html = html_of(thesis);
    CHECK(has(text, "cornell-box, PSWW: WRONG: 3 of 9 rays differ\n"));
    CHECK(has(text, "sibenik <hall>, PPacket: shared <meshes>\n"));
    CHECK(has(text, "sibenik <hall>, A: it is not in the report\n"));
    CHECK(count(html, "<td>WRONG</td>") == 2 * 2 * 3);     // PSWW in tables 6.3 and 6.6
    CHECK(count(html, "<td>-</td>") == 2 * 2 * 3 + 2 * 3); // PPacket in 6.4 and 6.6, A in 6.6
    CHECK(has(html, "<li class=\"wrong\">cornell-box, PSWW: WRONG: 3 of 9"));
    CHECK(has(html, "shared &lt;meshes&gt;"));
    check_page(html);
}

TEST_CASE("an interrupted chapter says so, and what it lacks") {
    ThesisReport thesis = full_thesis("CPU");
    thesis.scenes.pop_back(), thesis.local.pop_back();
    LabReport& report = thesis.scenes[0];
    report.interrupted = true;
    variant(report, "SWW-R", false).runs.pop_back();
    CombinationFigures& late = variant(report, "A", false);
    late.runs.clear(), late.refused = "interrupted before its turn";
    const std::string text = text_of(thesis), html = html_of(thesis);
    CHECK(has(text, "cornell-box: interrupted;"));
    CHECK(has(text, "cornell-box, SWW-R: interrupted before depth 3"));
    CHECK(has(text, "cornell-box, A: interrupted before its turn"));
    CHECK(has(text, "The second scene was not measured."));
    CHECK(has(html, "cornell-box: interrupted;"));
    check_page(html);
    check_page(html_of(ThesisReport{}));
    CHECK(has(text_of(ThesisReport{}), "Nothing was measured."));
}

TEST_CASE("a chapter of one depth has tables in place of curves") {
    ThesisReport thesis = full_thesis("CPU");
    for (LabReport& report : thesis.scenes) {
        report.sets.resize(1);
        for (CombinationFigures& c : report.combinations) c.runs.resize(1);
    }
    const std::string html = html_of(thesis);
    CHECK(!has(html, "<svg"));
    CHECK(has(html, "Figure 6.10: speculative while-while, with and without RTA: needs more than one depth"));
}
