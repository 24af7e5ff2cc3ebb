#include "apps/cli/lab_files.h"

#include <fmt/format.h>

#include "base/error.h"
#include "base/write_file_atomically.h"
#include "lab/lab_tables.h"
#include "lab/report_page.h"

namespace pertev {
void check_lab_folder(const std::filesystem::path& folder) {
    std::error_code error;
    std::filesystem::create_directories(folder, error);
    if (error) {
        throw Error(ErrorCode::FileWrite, FileLocation{folder.string()},
                    fmt::format("the folder cannot be created: {}", error.message()));
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

void fail_if_wrong(const LabReport& report) {
    std::string names;
    for (const CombinationFigures& c : report.combinations) {
        if (c.wrong) names += fmt::format("\n  {}: {}", c.name, c.refused);
    }
    if (!names.empty()) {
        throw Error(ErrorCode::DeviceFault,
                    fmt::format("{}: combinations that differ from the reference traversal:{}", report.scene, names));
    }
}

} // namespace pertev
