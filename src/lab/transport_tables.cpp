// text_of and the tables of write_transport.h.

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "base/byte_units.h"
#include "lab/text_table.h"
#include "lab/write_transport.h"

namespace pertev {
namespace {

std::string with_band(const Estimate& estimate) {
    const bool is_finite = std::isfinite(estimate.mean) && std::isfinite(estimate.half_width.value_or(0));
    return estimate.half_width && is_finite ? uncertain_text(estimate.mean, *estimate.half_width)
                                            : fmt::format("{:.3g}", estimate.mean);
}

struct TableLine {
    const TransportRow* row;
    std::optional<TransportPoint> point;
};

/// Of the rows with figures, the least relMSE first; those without a point last.
template <class PointOf>
std::vector<TableLine> lines_of(const TransportScene& scene, const PointOf& point_of) {
    std::vector<TableLine> lines;
    for (const TransportRow& row : scene.rows) {
        if (!row.repetitions.empty()) lines.push_back({&row, point_of(row)});
    }
    const auto error = [](const TableLine& line) {
        return line.point && std::isfinite(line.point->rel_mse.mean) ? line.point->rel_mse.mean
                                                                     : std::numeric_limits<double>::max();
    };
    std::ranges::stable_sort(lines, [&](const TableLine& a, const TableLine& b) { return error(a) < error(b); });
    return lines;
}

std::optional<double> efficiency_of_path(const std::vector<TableLine>& lines) {
    const auto path = std::ranges::find(lines, "path", [](const TableLine& line) { return line.row->name; });
    return path != lines.end() && path->point ? efficiency(*path->point) : std::nullopt;
}

/// Efficiency, and that over path's.
std::vector<std::string> efficiency_cells(const TableLine& line, const std::optional<double>& of_path) {
    const std::optional<double> own = efficiency(*line.point);
    if (!own) return {"", ""};
    return {fmt::format("{:.3g}", *own), of_path ? fmt::format("{:.3g}", *own / *of_path) : ""};
}

/// Of the device's memory, and where there is any the host's beside.
std::string memory_text(const TransportRow& row) {
    const std::string device = fmt::format("{:.1f}", mebibytes(row.bytes));
    return row.host_bytes > 0 ? fmt::format("{} + {:.1f}", device, mebibytes(row.host_bytes)) : device;
}

void add_cells(std::vector<std::string>& to, const std::vector<std::string>& cells) {
    to.insert(to.end(), cells.begin(), cells.end());
}

} // namespace

TransportTable equal_time_table(const TransportScene& scene) {
    const double seconds = equal_seconds(scene);
    const std::vector<TableLine> lines =
        lines_of(scene, [&](const TransportRow& row) { return at_time(row, seconds); });
    const std::optional<double> of_path = efficiency_of_path(lines);
    TransportTable table = {{"integrator", "relMSE", "HDR-FLIP", "samples", "1/(relMSE s)", "of path's", "MiB + host's",
                             "light that it finds"}};
    for (const TableLine& line : lines) {
        std::vector<std::string> cells = {line.row->name};
        if (line.point) {
            add_cells(cells, {with_band(line.point->rel_mse), with_band(line.point->flip),
                              line.row->is_solved
                                  ? fmt::format("{:.4g}; {:.0f} patches", line.point->samples, line.point->patches)
                                  : fmt::format("{:.4g}", line.point->samples)});
            add_cells(cells, efficiency_cells(line, of_path));
        } else {
            const char* what = line.row->is_solved ? "solution" : "sample";
            const std::string first =
                fmt::format("its first {} takes {:.3g} s", what, points_of(*line.row).front().seconds.mean);
            add_cells(cells, {first, "", "", "", ""});
        }
        add_cells(cells, {memory_text(*line.row), line.row->light});
        table.push_back(cells);
    }
    return table;
}

TransportTable equal_samples_table(const TransportScene& scene) {
    const uint32_t samples = equal_samples(scene);
    const std::vector<TableLine> lines =
        lines_of(scene, [&](const TransportRow& row) { return at_samples(row, samples); });
    const std::optional<double> of_path = efficiency_of_path(lines);
    TransportTable table = {{"integrator", "relMSE", "HDR-FLIP", "seconds", "1/(relMSE s)", "of path's"}};
    for (const TableLine& line : lines) {
        if (line.row->is_solved) table.push_back({line.row->name, "no samples: it is solved"});
        if (!line.point) continue;
        std::vector<std::string> cells = {line.row->name, with_band(line.point->rel_mse), with_band(line.point->flip),
                                          with_band(line.point->seconds)};
        add_cells(cells, efficiency_cells(line, of_path));
        table.push_back(cells);
    }
    return table;
}

std::string describe_reference(const TransportReference& reference) {
    if (!reference.file.empty()) return reference.file + "; its own noise is not known";
    if (!reference.rel_mse) return reference.integrator + "; it was not made";
    return fmt::format("{}, {} samples of each pixel, {:.3g} s; its own noise: relMSE {:.2g}, HDR-FLIP of one half "
                       "against the other {:.2g}",
                       reference.integrator, reference.samples, reference.seconds, *reference.rel_mse,
                       reference.flip.value_or(0));
}

std::vector<std::string> rows_without_figures(const TransportScene& scene) {
    std::vector<std::string> lines;
    for (const TransportRow& row : scene.rows) {
        if (!row.repetitions.empty()) continue;
        lines.push_back(
            fmt::format("{}: {}", row.name, row.refused.empty() ? "interrupted before its turn" : row.refused));
    }
    return lines;
}

std::string text_of(const TransportReport& report) {
    std::string text;
    for (const TransportScene& scene : report.scenes) {
        text += fmt::format("{}{}{}, {}x{}, at most {} scatterings, on {}\nreference: {}\n", text.empty() ? "" : "\n",
                            scene.name, scene.shows.empty() ? "" : " (" + scene.shows + ")", report.width,
                            report.height, report.max_depth, report.device, describe_reference(scene.reference));
        if (has_findings(scene)) {
            const std::string of = report.repetitions == 1
                                       ? "one repetition, so that nothing is known of its noise"
                                       : fmt::format("mean of {} repetitions ± 95 % confidence", report.repetitions);
            text += fmt::format("\nafter {:.3g} s of rendering each ({})\n{}", equal_seconds(scene), of,
                                align_columns(equal_time_table(scene)));
            text += fmt::format("\nafter {} samples of each pixel\n{}", equal_samples(scene),
                                align_columns(equal_samples_table(scene)));
        }
        const std::vector<std::string> without = rows_without_figures(scene);
        if (!without.empty() || !scene.notes.empty()) text += '\n';
        for (const std::string& line : without) text += line + '\n';
        for (const std::string& note : scene.notes) text += note + '\n';
    }
    if (report.interrupted) text += "\ninterrupted: this is what had been measured\n";
    return text;
}

} // namespace pertev
