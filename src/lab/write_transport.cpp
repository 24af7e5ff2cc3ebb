#include "lab/write_transport.h"

#include <fmt/format.h>

#include "base/json_text.h"
#include "lab/csv_line.h"

namespace pertev {
namespace {

// Each part of the CSV has its head beside its cells, in one order.

CsvCells common_head() {
    return {"device", "commit", "threads", "width", "height", "max_depth", "repetitions", "seed", "budget_seconds"};
}
CsvCells common_cells(const TransportReport& r) {
    return {r.device,
            r.commit,
            fmt::format("{}", r.threads),
            fmt::format("{}", r.width),
            fmt::format("{}", r.height),
            fmt::format("{}", r.max_depth),
            fmt::format("{}", r.repetitions),
            fmt::format("{}", r.seed),
            fmt::format("{:.6g}", r.seconds)};
}

CsvCells scene_head() {
    return {"scene", "interrupted", "reference", "reference_samples", "reference_seconds", "reference_rel_mse"};
}
CsvCells scene_cells(const TransportScene& s) {
    const TransportReference& r = s.reference;
    const bool is_made = r.file.empty();
    return {s.name,
            s.interrupted ? "1" : "0",
            is_made ? r.integrator : r.file,
            is_made ? fmt::format("{}", r.samples) : "",
            is_made ? fmt::format("{:.6g}", r.seconds) : "",
            r.rel_mse ? fmt::format("{:.9g}", *r.rel_mse) : ""};
}

CsvCells row_head() {
    return {"integrator", "light", "finds_all", "refused", "device_bytes", "host_bytes", "invalid_samples"};
}
CsvCells row_cells(const TransportRow& r) {
    const bool has_figures = !r.repetitions.empty();
    return {r.name,
            r.light,
            r.finds_all ? "1" : "0",
            r.refused,
            has_figures ? fmt::format("{}", r.bytes) : "",
            has_figures ? fmt::format("{}", r.host_bytes) : "",
            has_figures ? fmt::format("{}", r.invalid_samples) : ""};
}

std::string patches_of(const TransportFigures& f, const char* none) {
    return f.patches > 0 ? fmt::format("{}", f.patches) : none;
}

CsvCells figures_head() {
    return {"repetition", "samples", "seconds", "rel_mse", "hdr_flip", "patches", "made_seconds"};
}
CsvCells figures_cells(std::size_t repetition, const TransportFigures& f) {
    return {fmt::format("{}", repetition),        fmt::format("{}", f.samples),  fmt::format("{:.9f}", f.seconds),
            fmt::format("{:.9g}", f.rel_mse),     fmt::format("{:.9g}", f.flip), patches_of(f, ""),
            fmt::format("{:.9f}", f.made_seconds)};
}

CsvCells joined(std::initializer_list<CsvCells> parts) {
    CsvCells all;
    for (const CsvCells& part : parts) all.insert(all.end(), part.begin(), part.end());
    return all;
}

template <class All, class Text>
std::string json_list(const All& all, const Text& text) {
    std::string list;
    for (const auto& one : all) list += (list.empty() ? "" : ",") + text(one);
    return '[' + list + ']';
}

std::string number_or_null(const std::optional<double>& value) { return value ? json_number(*value) : "null"; }
std::string json_text_or_null(const std::string& text) { return text.empty() ? "null" : json_string(text); }

std::string json_of(const Estimate& e) {
    return fmt::format(R"({{"mean":{},"half_width":{}}})", json_number(e.mean), number_or_null(e.half_width));
}

std::string json_of(const TransportPoint& p) {
    return fmt::format(R"({{"samples":{},"repetitions":{},"seconds":{},"rel_mse":{},"hdr_flip":{},"efficiency":{}}})",
                       json_number(p.samples), p.repetitions, json_of(p.seconds), json_of(p.rel_mse), json_of(p.flip),
                       number_or_null(efficiency(p)));
}
std::string json_of(const std::optional<TransportPoint>& p) { return p ? json_of(*p) : "null"; }

std::string json_of(const TransportScene& scene, const TransportRow& row) {
    const auto figures = [](const TransportFigures& f) {
        return fmt::format(R"({{"samples":{},"seconds":{},"rel_mse":{},"hdr_flip":{},"patches":{},"made_seconds":{}}})",
                           f.samples, json_number(f.seconds), json_number(f.rel_mse), json_number(f.flip),
                           patches_of(f, "null"), json_number(f.made_seconds));
    };
    const auto repetition = [&](const Repetition& r) { return json_list(r, figures); };
    const bool has_figures = !row.repetitions.empty();
    return fmt::format(
        R"({{"name":{},"light":{},"finds_all":{},"refused":{},"is_solved":{},"device_bytes":{},"host_bytes":{},"invalid_samples":{},"at_equal_seconds":{},"at_equal_samples":{},"points":{},"repetitions":{}}})",
        json_string(row.name), json_string(row.light), row.finds_all, json_text_or_null(row.refused), row.is_solved,
        has_figures ? fmt::format("{}", row.bytes) : "null", has_figures ? fmt::format("{}", row.host_bytes) : "null",
        has_figures ? fmt::format("{}", row.invalid_samples) : "null", json_of(at_time(row, equal_seconds(scene))),
        json_of(at_samples(row, equal_samples(scene))),
        json_list(points_of(row), [](const TransportPoint& p) { return json_of(p); }),
        json_list(row.repetitions, repetition));
}

std::string json_of(const TransportReference& r) {
    const bool is_made = r.file.empty();
    return fmt::format(
        R"({{"file":{},"integrator":{},"samples":{},"seconds":{},"rel_mse":{},"hdr_flip_of_halves":{},"lacks":{}}})",
        json_text_or_null(r.file), json_text_or_null(r.integrator), is_made ? fmt::format("{}", r.samples) : "null",
        is_made ? json_number(r.seconds) : "null", number_or_null(r.rel_mse), number_or_null(r.flip),
        json_text_or_null(r.lacks));
}

std::string json_of(const TransportScene& scene) {
    return fmt::format(
        R"({{"scene":{},"shows":{},"camera":{},"triangles":{},"interrupted":{},"equal_seconds":{},"equal_samples":{},"reference":{},"notes":{},"integrators":{}}})",
        json_string(scene.name), json_text_or_null(scene.shows), json_string(scene.camera), scene.triangles,
        scene.interrupted, json_number(equal_seconds(scene)), equal_samples(scene), json_of(scene.reference),
        json_list(scene.notes, json_string),
        json_list(scene.rows, [&](const TransportRow& row) { return json_of(scene, row); }));
}

} // namespace

std::string csv_of(const TransportReport& report) {
    std::string csv = csv_line(joined({common_head(), scene_head(), row_head(), figures_head()}));
    for (const TransportScene& scene : report.scenes) {
        for (const TransportRow& row : scene.rows) {
            const auto add = [&](const CsvCells& figures) {
                csv += csv_line(joined({common_cells(report), scene_cells(scene), row_cells(row), figures}));
            };
            if (row.repetitions.empty()) add(CsvCells(figures_head().size()));
            for (std::size_t i = 0; i < row.repetitions.size(); ++i) {
                for (const TransportFigures& figures : row.repetitions[i]) add(figures_cells(i, figures));
            }
        }
    }
    return csv;
}

std::string json_of(const TransportReport& report) {
    return fmt::format(
        R"({{"event":"transport","device":{},"commit":{},"threads":{},"width":{},"height":{},"max_depth":{},"repetitions":{},"seed":{},"budget_seconds":{},"confidence":0.95,"interrupted":{},"scenes":{}}})",
        json_string(report.device), json_string(report.commit), report.threads, report.width, report.height,
        report.max_depth, report.repetitions, report.seed, json_number(report.seconds), report.interrupted,
        json_list(report.scenes, [](const TransportScene& scene) { return json_of(scene); }));
}

} // namespace pertev
