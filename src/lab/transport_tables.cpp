#include "lab/transport_tables.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "base/machine_memory.h"

namespace pertev {
namespace {

struct TableLine {
    const TransportRow* row;
    std::optional<TransportPoint> point;
};

/// Returns rows with figures, the smallest relMSE first; rows without a point come last.
template <class PointOf>
std::vector<TableLine> lines_of(const TransportScene& scene, const PointOf& point_of) {
    std::vector<TableLine> lines;
    for (const TransportRow& row : scene.rows) {
        if (!row.repetitions.empty()) lines.push_back({&row, point_of(row)});
    }
    std::ranges::stable_sort(lines, {}, [](const TableLine& line) {
        const bool has_error = line.point && std::isfinite(line.point->rel_mse.mean);
        return has_error ? line.point->rel_mse.mean : std::numeric_limits<double>::max();
    });
    return lines;
}

std::optional<double> efficiency_of_path(const std::vector<TableLine>& lines) {
    const auto path = std::ranges::find(lines, "path", [](const TableLine& line) { return line.row->name; });
    return path != lines.end() && path->point ? efficiency(*path->point) : std::nullopt;
}

template <class Value>
ResultCell value_at(const std::optional<TransportPoint>& point, const Value& value) {
    return point ? ResultCell(value(*point)) : ResultCell();
}

/// Makes the fields of a point: errors with half widths of their 95 % intervals, and efficiency with its ratio to
/// that of path.
Fields point_fields(const TableLine& line, const std::optional<double>& of_path) {
    const auto own = line.point ? efficiency(*line.point) : std::nullopt;
    const auto& p = line.point;
    return {
        {"rel_mse", "relMSE", value_at(p, [](const auto& at) { return at.rel_mse.mean; }), "", "{:.3g}"},
        {"rel_mse_half_width", "±", value_at(p, [](const auto& at) { return at.rel_mse.half_width; }), "", "{:.2g}"},
        {"hdr_flip", "HDR-FLIP", value_at(p, [](const auto& at) { return at.flip.mean; }), "", "{:.3g}"},
        {"hdr_flip_half_width", "±", value_at(p, [](const auto& at) { return at.flip.half_width; }), "", "{:.2g}"},
        {"efficiency", "1/(relMSE s)", own, "", "{:.3g}"},
        {"of_path", "ratio to path", own && of_path ? ResultCell(*own / *of_path) : ResultCell(), "", "{:.3g}"}};
}

Fields scene_fields(const TransportScene& s) {
    const TransportReference& r = s.reference;
    const bool is_made = r.file.empty();
    return {{"scene", "scene", s.name},
            {"interrupted", "", s.interrupted},
            {"reference", "reference", is_made ? r.integrator : r.file},
            {"reference_samples", "reference samples", is_made ? ResultCell(r.samples) : ResultCell()},
            {"reference_seconds", "reference time", is_made ? ResultCell(r.seconds) : ResultCell(), "s", "{:.3g}"},
            {"reference_rel_mse", "reference relMSE", r.rel_mse, "", "{:.2g}"}};
}

ResultTable scenes_of(const TransportReport& report) {
    ResultTable table = {"scenes", "Scenes"};
    for (const TransportScene& s : report.scenes) {
        table.add(scene_fields(s) +
                  Fields{{"reference_hdr_flip_of_halves", "HDR-FLIP of the reference's halves", s.reference.flip},
                         {"reference_lacks", "missing light", if_not_empty(s.reference.lacks)},
                         {"equal_seconds", "equal time", equal_seconds(s), "s"},
                         {"triangles", "triangles", s.triangles},
                         {"width", "width", report.width},
                         {"height", "height", report.height},
                         {"max_depth", "max depth", report.max_depth},
                         {"repetitions", "repetitions", report.repetitions},
                         {"seed", "seed", report.seed},
                         {"budget_seconds", "time per integrator", report.seconds, "s"},
                         {"camera", "camera", s.camera},
                         {"shows", "shows", if_not_empty(s.shows)}});
    }
    return table;
}

/// Adds means over repetitions with their confidence intervals, which a page draws.
void add_points(const TransportScene& scene, ResultTable& table) {
    for (const TransportRow& row : scene.rows) {
        for (const TransportPoint& p : points_of(row)) {
            const auto edge = [](const Estimate& e, double sign) {
                return e.half_width ? ResultCell(e.mean + sign * *e.half_width) : ResultCell();
            };
            table.add({{"scene", "scene", scene.name},
                       {"integrator", "integrator", row.name},
                       {"finds_all", "finds all light", row.finds_all},
                       {"is_solved", "is solved", row.is_solved},
                       {"samples", "samples per pixel", p.samples},
                       {"patches", "patches", p.patches > 0 ? ResultCell(p.patches) : ResultCell()},
                       {"repetitions", "repetitions", p.repetitions},
                       {"seconds", "rendering", p.seconds.mean, "s"},
                       {"seconds_half_width", "±", p.seconds.half_width, "s"},
                       {"rel_mse", "relMSE", p.rel_mse.mean},
                       {"rel_mse_low", "relMSE, low", edge(p.rel_mse, -1)},
                       {"rel_mse_high", "relMSE, high", edge(p.rel_mse, 1)},
                       {"hdr_flip", "HDR-FLIP", p.flip.mean},
                       {"hdr_flip_low", "HDR-FLIP, low", edge(p.flip, -1)},
                       {"hdr_flip_high", "HDR-FLIP, high", edge(p.flip, 1)},
                       {"efficiency", "1/(relMSE s)", efficiency(p)},
                       {"reference_rel_mse", "relMSE of the reference", scene.reference.rel_mse}});
        }
    }
}

ResultTable repetitions_of(const TransportReport& report) {
    ResultTable table = {"repetitions", "All repetitions"};
    for (const TransportScene& scene : report.scenes) {
        for (const TransportRow& row : scene.rows) {
            const bool has_figures = !row.repetitions.empty();
            const Fields first =
                scene_fields(scene) +
                Fields{{"integrator", "integrator", row.name},
                       {"light", "light found", row.light},
                       {"finds_all", "finds all", row.finds_all},
                       {"is_solved", "is solved", row.is_solved},
                       {"refused", "not run because", if_not_empty(row.refused)},
                       {"device_bytes", "device memory", has_figures ? ResultCell(row.bytes) : ResultCell(), "bytes"},
                       {"host_bytes", "host memory", has_figures ? ResultCell(row.host_bytes) : ResultCell(), "bytes"},
                       {"invalid_samples", "invalid samples",
                        has_figures ? ResultCell(row.invalid_samples) : ResultCell()}};
            const auto add = [&](std::optional<std::size_t> repetition, const std::optional<TransportFigures>& f) {
                const auto figure = [&](auto member) { return f ? ResultCell((*f).*member) : ResultCell(); };
                table.add(first +
                          Fields{{"repetition", "repetition", repetition},
                                 {"samples", "samples", figure(&TransportFigures::samples)},
                                 {"seconds", "rendering", figure(&TransportFigures::seconds), "s"},
                                 {"rel_mse", "relMSE", figure(&TransportFigures::rel_mse)},
                                 {"hdr_flip", "HDR-FLIP", figure(&TransportFigures::flip)},
                                 {"patches", "patches", f && f->patches > 0 ? ResultCell(f->patches) : ResultCell()},
                                 {"made_seconds", "preparation", figure(&TransportFigures::made_seconds), "s"}});
            };
            if (!has_figures) add({}, {});
            for (std::size_t i = 0; i < row.repetitions.size(); ++i) {
                for (const TransportFigures& figures : row.repetitions[i]) add(i, figures);
            }
        }
    }
    return table;
}

/// Returns a line for each integrator without figures, for example "cast: point, spot and ... lights alone".
std::vector<std::string> rows_without_figures(const TransportScene& scene) {
    std::vector<std::string> lines;
    for (const TransportRow& row : scene.rows) {
        if (!row.repetitions.empty()) continue;
        lines.push_back(
            fmt::format("{}: {}", row.name, row.refused.empty() ? "interrupted before it was rendered" : row.refused));
    }
    return lines;
}

/// Appends the rows of `part`, each preceded by the scene's name.
void add_all(const TransportScene& scene, ResultTable part, ResultTable& all) {
    all.columns = std::move(part.columns);
    all.columns.insert(all.columns.begin(), {"scene", "scene", "", ""});
    for (std::vector<ResultCell>& row : part.rows) {
        row.insert(row.begin(), scene.name);
        all.rows.push_back(std::move(row));
    }
}

} // namespace

ResultTable equal_time_table(const TransportScene& scene) {
    const double seconds = equal_seconds(scene);
    const std::vector<TableLine> lines =
        lines_of(scene, [&](const TransportRow& row) { return at_time(row, seconds); });
    const std::optional<double> of_path = efficiency_of_path(lines);
    ResultTable table = {"equal_time", fmt::format("After {:.3g} s of rendering each", seconds)};
    for (const TableLine& line : lines) {
        const TransportRow& row = *line.row;
        const auto& p = line.point;
        table.add(
            Fields{{"integrator", "integrator", row.name}} + point_fields(line, of_path) +
            Fields{{"samples", "samples", value_at(p, [](const auto& at) { return at.samples; }), "", "{:.4g}"},
                   {"patches", "patches", p && row.is_solved ? ResultCell(p->patches) : ResultCell(), "", "{:.0f}"},
                   {"first_seconds", "first picture",
                    p ? ResultCell() : ResultCell(points_of(row).front().seconds.mean), "s", "{:.3g}"},
                   {"device_mebibytes", "device", mebibytes(row.bytes), "MiB", "{:.1f}"},
                   {"host_mebibytes", "host", row.host_bytes > 0 ? ResultCell(mebibytes(row.host_bytes)) : ResultCell(),
                    "MiB", "{:.1f}"},
                   {"light", "light found", row.light}});
    }
    return table;
}

Measurement measurement_of(const TransportReport& report, Measurement m) {
    m.kind = "transport", m.title = "Laboratory of light transport";
    m.interrupted = report.interrupted;
    ResultTable by_time = {"equal_time", "At equal time"}, points = {"points", "Means over repetitions"};
    for (const TransportScene& scene : report.scenes) {
        if (has_findings(scene)) add_all(scene, equal_time_table(scene), by_time);
        add_points(scene, points);
        for (const auto& lines : {rows_without_figures(scene), scene.notes}) {
            for (const std::string& line : lines) m.notes.push_back(scene.name + ": " + line);
        }
        m.pictures.insert(m.pictures.end(), scene.pictures.begin(), scene.pictures.end());
    }
    m.tables = {scenes_of(report), by_time, points, repetitions_of(report)};
    return m;
}

std::string text_of(const TransportReport& report) {
    const Measurement m = measurement_of(report);
    std::string text;
    for (const TransportScene& scene : report.scenes) {
        text += fmt::format("{}, reference: {}\n", scene.name, describe_reference(scene.reference));
    }
    text += '\n' + text_of(m.table("equal_time")) + '\n';
    for (const std::string& note : m.notes) text += note + '\n';
    if (report.interrupted) text += "interrupted: the results are incomplete\n";
    return text;
}

} // namespace pertev
