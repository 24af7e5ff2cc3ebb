#include "apps/cli/lab_files.h"

#include <fmt/format.h>

#include "apps/cli/interrupt.h"
#include "base/error.h"
#include "base/write_file_atomically.h"
#include "lab/lab_tables.h"
#include "lab/report_page.h"

namespace pertev {
namespace {

void show(const LabProgress& now, Reporter& reporter) {
    const double left_s = now.share > 0.01 ? now.seconds * (1 - now.share) / now.share : 0;
    const std::string of_that = now.share_of_that > 0 ? fmt::format(" ({:.0f} %)", 100 * now.share_of_that) : "";
    reporter.progress(
        now.share, fmt::format("{}{}{}", now.doing, of_that, left_s > 0 ? fmt::format(", {:.0f} s left", left_s) : ""));
    reporter.event(fmt::format(
        R"({{"event":"progress","share":{:.4f},"doing":{},"share_of_that":{:.4f},"seconds":{:.3f},"seconds_left":{}}})",
        now.share, json_string(now.doing), now.share_of_that, now.seconds, left_s > 0 ? json_number(left_s) : "null"));
}

} // namespace

void check_lab_folder(const std::filesystem::path& folder) {
    std::error_code error;
    std::filesystem::create_directories(folder, error);
    if (error) {
        throw Error(ErrorCode::FileWrite, FileLocation{folder.string()},
                    fmt::format("cannot be made: {}", error.message()));
    }
    check_writable(folder / "report.csv");
}

void write_text(const std::filesystem::path& path, const std::string& text) {
    write_file_atomically(path, std::as_bytes(std::span(text)));
}

void write_measurement(const std::filesystem::path& folder, const std::string& name, const Measurement& measurement,
                       std::string_view csv_table) {
    write_text(folder / (name + ".csv"), csv_of(measurement, csv_table));
    write_text(folder / (name + ".json"), json_of(measurement) + '\n');
    const std::string json = json_of(measurement, "", true);
    write_text(folder / (name + ".html"), report_page({&json, 1}));
}

std::function<bool(const LabProgress&)> show_lab_progress(Reporter& reporter, const std::filesystem::path& folder,
                                                          const Measurement& head) {
    return [&reporter, folder, head, last_doing = std::string(), last_s = 0.0](const LabProgress& now) mutable {
        constexpr double often_s = 0.1; // enough for eyes
        if (now.doing != last_doing || now.seconds - last_s >= often_s) {
            last_doing = now.doing, last_s = now.seconds;
            show(now, reporter);
        }
        if (now.so_far != nullptr && !folder.empty() && has_findings(*now.so_far)) {
            write_measurement(folder, "report", measurement_of(*now.so_far, head), "runs");
        }
        return !interrupted();
    };
}

void fail_if_wrong(const LabReport& report) {
    std::string names;
    for (const CombinationFigures& c : report.combinations) {
        if (c.wrong) names += fmt::format("\n  {}: {}", c.name, c.refused);
    }
    if (!names.empty()) {
        throw Error(ErrorCode::DeviceFault,
                    fmt::format("{}: combinations that differ from the proven traversal:{}", report.scene, names));
    }
}

} // namespace pertev
