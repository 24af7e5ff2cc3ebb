#include <doctest/doctest.h>

#include <algorithm>

#include "lab/heat_map.h"
#include "lab/svg_plot.h"
#include "lab/write_html.h"
#include "lab/write_tables.h"

using namespace pertev;

namespace {

LabReport small_report() {
    LabReport report;
    report.scene = "a \"quoted\", scene <&>";
    report.device = "CPU";
    report.triangles = 1000, report.width = 4, report.height = 2, report.runs = 20, report.warm_ups = 1;
    report.sets = {{.name = "primary", .depth = 1, .rays = 8'000'000, .hit_share = 0.5},
                   {.name = "shadow", .any_hit = true, .rays = 4'000'000},
                   {.name = "diffuse1", .depth = 2, .rays = 2'000'000}};
    report.structures = {{.name = "binned",
                          .build_s = 0.25,
                          .nodes = 999,
                          .triangles = 1000,
                          .bytes = 64'000,
                          .sah_cost = 12,
                          .depth = 9}};
    CombinationFigures fast = {.combination = {}, .structure = 0, .name = "binned while-while rta near", .refused = ""};
    fast.runs = {{.set = 0, .median_s = 2, .least_s = 1, .largest_s = 4, .nodes = 10, .triangles = 2},
                 {.set = 1, .median_s = 1, .least_s = 1, .largest_s = 1},
                 {.set = 2, .median_s = 0.5, .least_s = 0.5, .largest_s = 0.5}};
    CombinationFigures refused = {
        .combination = {.walk = WalkKind::Kd}, .structure = 0, .name = "binned kd", .refused = "no <planes>, none"};
    report.combinations = {fast, refused};
    HeatMap map = {"binned while-while rta near", 4, 2, {0, 1, 2, 3, 4, 5, 6, 7}, {7, 6, 5, 4, 3, 2, 1, 0}};
    report.heat_maps.push_back(map);
    return report;
}

std::size_t count(const std::string& text, const std::string& part) {
    std::size_t n = 0;
    for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + part.size())) ++n;
    return n;
}

} // namespace

TEST_CASE("a frame of depth d is the sets of depths 1 to d, and needs all of them") {
    LabReport report = small_report();
    const CombinationFigures& c = report.combinations[0];
    CHECK(frame_seconds(report, c, 1) == doctest::Approx(2));
    CHECK(frame_seconds(report, c, 2) == doctest::Approx(2.5));
    CHECK(frame_seconds(report, c, 3) == 0);
    CHECK(frame_seconds(report, report.combinations[1], 1) == 0);
    CHECK(frame_rays(report, 2) == 10'000'000);
    CHECK(largest_depth(report) == 2);
    CHECK(mrays(report, c.runs[0]) == doctest::Approx(4));
}

TEST_CASE("every line of the CSV has as many fields as its head, quoted ones included") {
    const std::string csv = csv_of(small_report());
    std::size_t fields = 0, lines = 0;
    std::size_t wanted = 0;
    bool quoted = false;
    for (const char c : csv) {
        if (c == '"') quoted = !quoted;
        if (!quoted && (c == ',' || c == '\n')) ++fields;
        if (!quoted && c == '\n') {
            if (lines++ == 0) wanted = fields;
            CHECK(fields == wanted);
            fields = 0;
        }
    }
    CHECK(lines == 1 + 3 + 1);
    CHECK(csv.find("\"a \"\"quoted\"\", scene <&>\"") != std::string::npos);
    CHECK(csv.find("\"no <planes>, none\"") != std::string::npos);
}

TEST_CASE("the HTML report stands alone, escapes names, and shows bars, curves, refusals and pictures") {
    const std::string html = html_of(small_report());
    CHECK(html.starts_with("<!DOCTYPE html>"));
    CHECK(html.find("http://") == html.find("http://www.w3.org/2000/svg")); // nothing is fetched
    CHECK(html.find("https://") == std::string::npos);
    CHECK(html.find("<script") == std::string::npos);
    CHECK(html.find("scene &lt;&amp;&gt;") != std::string::npos);
    CHECK(html.find("no &lt;planes&gt;") != std::string::npos);
    CHECK(count(html, "<svg") == 3 + 2); // a bar chart a set, two curves
    CHECK(count(html, "data:image/png;base64,iVBORw0KGgo") == 2);
    for (const char* tag : {"table", "svg", "figure", "tr", "td", "text", "h2"}) {
        CAPTURE(tag);
        CHECK(count(html, std::string("<") + tag + ">") + count(html, std::string("<") + tag + " ") ==
              count(html, std::string("</") + tag + ">"));
    }
}

TEST_CASE("JSON has the figures and null for what is not a number") {
    LabReport report = small_report();
    report.structures[0].sah_cost = 1.0 / 0.0;
    const std::string json = json_of(report);
    CHECK(json.find(R"("frame_seconds":[2,2.5])") != std::string::npos);
    CHECK(json.find(R"("sah_cost":null)") != std::string::npos);
    CHECK(count(json, "{") == count(json, "}"));
}

TEST_CASE("an axis has at most the steps asked for, at 1, 2 or 5 times a power of ten") {
    for (const double most : {0.003, 0.9, 1.0, 7.0, 12.0, 99.0, 2e6}) {
        const double step = axis_step(most, 6);
        CAPTURE(most);
        CHECK(step * 6 >= most);
        CHECK(step * 6 / 6 < most * 1.0001);
        double mantissa = step;
        while (mantissa < 0.99) mantissa *= 10;
        while (mantissa > 9.9) mantissa /= 10;
        const bool round =
            std::abs(mantissa - 1) < 1e-9 || std::abs(mantissa - 2) < 1e-9 || std::abs(mantissa - 5) < 1e-9;
        CHECK(round);
    }
}

TEST_CASE("a heat map gets lighter as counts rise, and carries its scale below") {
    const auto light = [](FalseColor c) { return 2 * c.r + 7 * c.g + c.b; };
    for (int i = 1; i <= 50; ++i) {
        CHECK(light(false_color(static_cast<float>(i) / 50)) >= light(false_color(static_cast<float>(i - 1) / 50)));
    }
    std::vector<uint32_t> counts(64 * 32, 5);
    counts[64 * 31 + 63] = 1'000'000;
    CHECK(scale_end(counts) == 5); // one mad pixel does not darken the rest
    CHECK(scale_end({}) == 1);
    const Rgba8Image image = draw_heat_map(counts, 64, 32, 10);
    CHECK(image.width == 64);
    CHECK(image.height == 48);
    const FalseColor middle = false_color(0.5f);
    CHECK(image.pixels[0] == middle.r);
    CHECK(image.pixels[1] == middle.g);
    const std::size_t bottom = std::size_t(4) * 64 * 47;
    CHECK(image.pixels[bottom + 4 * 63] > image.pixels[bottom]);
}
