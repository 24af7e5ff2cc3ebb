// The output of measurements: cells, JSON, CSV, text, and the page that contains the JSON.

#include <doctest/doctest.h>

#include <array>

#include "device/queue.h"
#include "lab/measurement.h"
#include "lab/report_page.h"
#include "tests/support/small_lab_report.h"

using namespace pertev;
using namespace pertev::test;

namespace {

ResultTable two_rows() {
    ResultTable table = {"times", "Times of <all>"};
    table.add({{"name", "name", "a \"b\", c"}, {"seconds", "time", 0.25, "s", "{:.3f}"}, {"bytes", "", 12345678901}});
    table.add({{"name", "name", std::optional<std::string>()}, {"seconds", "time", 0.0}, {"bytes", "", true}});
    return table;
}

} // namespace

TEST_CASE("a cell without a value is null in JSON and empty in CSV, and 0 is a value") {
    CHECK(ResultCell().json() == "null");
    CHECK(ResultCell().csv().empty());
    CHECK(ResultCell().text("") == "-");
    CHECK(ResultCell(0).json() == "0");
    CHECK(ResultCell(0.0).csv() == "0");
    CHECK(ResultCell(true).json() == "true");
    CHECK(ResultCell(true).csv() == "1");
    CHECK(ResultCell(std::optional<double>()).json() == "null");
    CHECK(ResultCell(1.0 / 0.0).json() == "null");
    CHECK(ResultCell(1.0 / 0.0).csv().empty());
    CHECK(ResultCell(12345678901).json() == "12345678901"); // whole numbers keep all their digits
    CHECK(ResultCell(0.000039).text("{:.3f}") == "3.9e-05");
    CHECK(ResultCell(0.5).text("{:.3f}") == "0.500");
}

TEST_CASE("tables become CSV and aligned text") {
    Measurement m = {.program = "p", .date = "d", .processor = "a, b", .threads = 2, .tables = {two_rows()}};
    CHECK(csv_of(m, "times") == "program,date,processor,threads,device,name,seconds,bytes\n"
                                "p,d,\"a, b\",2,CPU,\"a \"\"b\"\", c\",0.25,12345678901\np,d,\"a, b\",2,CPU,,0,1\n");
    m.tables.push_back({"scene", "Scene"});
    m.tables.back().add({{"x", "", std::optional<int>()}, {"y", "", 2}});
    CHECK(has(csv_of(m, "times"), "device,x,y,name,"));
    CHECK(has(csv_of(m, "times"), ",CPU,,2,,0,1\n"));
    CHECK(text_of(two_rows()) ==
          "name      time s\na \"b\", c   0.250\n-          0.000\n"); // the column of bytes has no title
    ResultTable signs = {"signs", "Signs"};
    signs.add({{"a", "longer name", "x"}, {"b", "y", "±1%"}}); // ± is one character of two bytes
    CHECK(text_of(signs) == "longer name    y\nx            ±1%\n");
    const Fields fields = {{"a", "±", "x"}, {"b", "wide", "y", "s"}, {"c", "", "z"}};
    CHECK(text_of(fields) == "±     x\nwide  y s\n");
    CHECK(two_rows().at(0, "seconds") == 0.25);
}

TEST_CASE("a pivoted table has a row and a column per value, and gaps") {
    ResultTable table = {"rates", "Rates"};
    const auto add = [&](const char* tree, ResultCell set, double rate) {
        table.add({{"tree", "tree", tree}, {"set", "set", set}, {"rate", "", rate, "", "{:.1f}"}});
    };
    add("a", "near", 1), add("b", "far", 4), add("a", "far", 2), add("c", {}, 9);
    CHECK(text_of(pivot(table, "tree", "set", "rate")) == "tree  near  far\na      1.0  2.0\nb        -  4.0\n");
}

TEST_CASE("a measurement has machine, command and date, and tables with keys, titles and units") {
    const Queue cpu = Queue::make_cpu();
    Measurement m = start_measurement(cpu, "Test");
    CHECK(has(m.command, "_tests"));
    CHECK(m.threads > 0);
    CHECK(m.date.size() == std::string("2026-11-26T08:00:00Z").size());
    m.processor = "Some <CPU>", m.tables = {two_rows()}, m.notes = {"a note"};
    const std::string json = json_of(m);
    CHECK(json.starts_with(
        R"({"format":"pertev-measurement","version":1,"kind":null,"title":"Test","program":"pertev )"));
    CHECK(has(json, R"("processor":"Some <CPU>","threads":)"));
    CHECK(
        has(json,
            R"("device":null,"driver":null,"interrupted":false,"tables":[{"name":"times","title":"Times of <all>",)"));
    CHECK(has(json,
              R"("columns":[{"key":"name","title":"name","unit":""},{"key":"seconds","title":"time","unit":"s"},)"));
    CHECK(
        has(json,
            R"({"key":"bytes","title":"bytes","unit":""}],"rows":[["a \"b\", c",0.25,12345678901],[null,0,true]]}])"));
    CHECK(has(json, R"("notes":["a note"],"pictures":[]})"));
    CHECK(json_of(m, "lab").starts_with(R"({"event":"lab","format":)"));
    CHECK(json_of("rays", {{"set", "", "primary"}, {"rays", "", 3}}) == R"({"event":"rays","set":"primary","rays":3})");
}

TEST_CASE("the page holds the JSON of each measurement and needs nothing else") {
    Measurement m = {.kind = "lab", .title = "</script><b>"};
    m.pictures.push_back({.group = "g", .title = "t", .image = {1, 1, {1, 2, 3, 255}}, .exr = "a.exr"});
    const std::array<std::string, 2> all = {json_of(m, "", true), json_of(m)};
    const std::string page = report_page(all);
    CHECK(page.starts_with("<!DOCTYPE html>"));
    CHECK(page.ends_with("</html>\n"));
    CHECK(count(page, "class=\"measurement\">{") == 2);
    CHECK(count(page, "\\u003c/script>\\u003cb>") == 2); // a text cannot end the element
    CHECK(count(page, "data:image/png;base64,iVBORw0KGgo") == 1);
    CHECK(!has(page, "{{"));
    CHECK(count(page, "http") == 1); // this is the name of a namespace, which is not fetched
    CHECK(has(page, R"("exr":"a.exr")"));
    CHECK(embedded_file("nothing").empty());
}
