#include "apps/cli/lab_files.h"

#include <algorithm>
#include <array>
#include <vector>

#include <fmt/format.h>

#include "apps/cli/interrupt.h"
#include "base/error.h"
#include "base/write_file_atomically.h"
#include "image/write_png.h"
#include "lab/heat_map.h"
#include "lab/lab_tables.h"
#include "lab/report_page.h"

namespace pertev {
namespace {

/// Returns the files of a combination's heat maps, nodes first.
std::array<std::string, 2> heat_map_files(std::string combination) {
    std::ranges::replace(combination, ' ', '-');
    return {"nodes-" + combination + ".png", "triangles-" + combination + ".png"};
}

/// Returns the files of every combination that exists, on any device.
std::set<std::string> all_heat_map_files() {
    std::set<std::string> files;
    for (const StructureKind structure : kValuesOf<StructureKind>) {
        for (const TraversalKind traversal : kValuesOf<TraversalKind>) {
            if (why_not(structure, traversal)) continue;
            for (const Distribution distribution :
                 {Distribution::OneAThread, Distribution::Persistent, Distribution::DynamicFetch}) {
                for (const TestKind tests : kValuesOf<TestKind>) {
                    for (int bits = 0; bits < 8; ++bits) { // rta off, at nodes alone, on
                        const TraversalOptions options = {(bits & 3) != 0, (bits & 4) != 0, tests, (bits & 3) != 1};
                        const auto names =
                            heat_map_files(name_of(Combination{structure, traversal, options, distribution}));
                        files.insert(names.begin(), names.end());
                    }
                }
            }
        }
    }
    return files;
}

void write_heat_map(const std::filesystem::path& folder, const HeatMap& map) {
    const auto [nodes, triangles] = heat_map_files(map.name);
    write_png(folder / nodes, draw_heat_map(map.nodes, map.width, map.height, scale_end(map.nodes)));
    write_png(folder / triangles, draw_heat_map(map.triangles, map.width, map.height, scale_end(map.triangles)));
}

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
        throw Error(ErrorCode::FileWrite, fmt::format("{}: cannot be made: {}", folder.string(), error.message()));
    }
    check_writable(folder / "report.csv");
}

void write_text(const std::filesystem::path& path, const std::string& text) {
    write_file_atomically(path, std::as_bytes(std::span(text)));
}

void remove_files(const std::filesystem::path& folder, const std::set<std::string>& names) {
    std::error_code error; // files that cannot be removed or listed stay
    std::vector<std::filesystem::path> found;
    for (std::filesystem::directory_iterator at(folder, error), end; !error && at != end; at.increment(error)) {
        const bool is_file = std::filesystem::is_regular_file(at->symlink_status(error));
        if (is_file && names.contains(at->path().filename().string())) found.push_back(at->path());
    }
    for (const std::filesystem::path& file : found) std::filesystem::remove(file, error);
}

void write_measurement(const std::filesystem::path& folder, const std::string& name, const Measurement& measurement) {
    write_text(folder / (name + ".json"), json_of(measurement) + '\n');
    const std::string json = json_of(measurement, "", true);
    write_text(folder / (name + ".html"), report_page({&json, 1}));
}

void write_lab_files(const std::filesystem::path& folder, const LabReport& report, const Measurement& head,
                     Reporter& reporter) {
    write_text(folder / "report.csv", csv_of(report));
    write_measurement(folder, "report", measurement_of(report, head));
    std::set<std::string> stale = all_heat_map_files();
    for (const std::string& name : report.heat_map_names) {
        for (const std::string& file : heat_map_files(name)) stale.erase(file);
    }
    remove_files(folder, stale);
    reporter.print(fmt::format("written: {}", (folder / "report.html").string()));
}

std::function<bool(const LabProgress&)> show_lab_progress(Reporter& reporter, const std::filesystem::path& folder,
                                                          const Measurement& head) {
    return [&reporter, folder, head, last_doing = std::string(), last_s = 0.0](const LabProgress& now) mutable {
        constexpr double often_s = 0.1; // enough for eyes
        if (now.doing != last_doing || now.seconds - last_s >= often_s) {
            last_doing = now.doing, last_s = now.seconds;
            show(now, reporter);
        }
        if (now.heat_map != nullptr && !folder.empty()) write_heat_map(folder, *now.heat_map);
        if (now.so_far != nullptr && !folder.empty() && has_findings(*now.so_far)) {
            write_text(folder / "report.csv", csv_of(*now.so_far));
            write_text(folder / "report.json", json_of(measurement_of(*now.so_far, head)) + '\n');
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
