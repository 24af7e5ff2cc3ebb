// pertev bench page: one page that draws measurements of any number of files, and opens without a network.

#include <memory>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "apps/cli/bench_parts.h"
#include "apps/cli/flag_checks.h"
#include "base/error.h"
#include "base/write_file_atomically.h"
#include "formats/json/json_file.h"
#include "lab/report_page.h"

namespace pertev {
namespace {

struct PageFlags {
    std::vector<std::string> files;
    std::string output;
    ReportFlags report;
};

std::string read_measurement(const std::string& file) {
    const JsonFile json(file);
    if (json.root().string_or("format", "") != "pertev-measurement" || json.root().unsigned_or("version", 0) != 1) {
        throw Error(ErrorCode::BadInput, FileLocation{file},
                    "not a measurement of pertev (format pertev-measurement, version 1)");
    }
    return json.root().to_json();
}

int make_page(const PageFlags& flags) {
    Reporter reporter(flags.report);
    std::vector<std::string> measurements;
    for (const std::string& file : flags.files) measurements.push_back(read_measurement(file));
    const std::string page = report_page(measurements);
    reporter.write_output(flags.output, [&] { write_file_atomically(flags.output, std::as_bytes(std::span(page))); });
    reporter.print(fmt::format("written: {}", flags.output));
    return 0;
}

} // namespace

void add_bench_page_command(CLI::App& bench, int& status) {
    const auto flags = std::make_shared<PageFlags>();
    CLI::App& verb = add_bench_verb(bench, "page", "Write a page of measurements: tables, plots, pictures",
                                    [flags, &status] { status = make_page(*flags); });
    verb.add_option("MEASUREMENT", flags->files, "JSON files of bench --report, of lab -o, or bench/results")
        ->type_name("")
        ->required();
    verb.add_option("-o,--output", flags->output, "the page")->type_name("PAGE.html")->required();
    add_report_flags(verb, flags->report);
}

} // namespace pertev
