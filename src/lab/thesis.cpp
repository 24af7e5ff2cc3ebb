#include "lab/thesis.h"

#include <algorithm>

#include <fmt/format.h>

#include "lab/text_table.h"

namespace pertev {
namespace {

constexpr const char* kTree = "Every column traverses the same tree: binned, top down by the surface area heuristic.";

constexpr TraversalOptions kWithRta = {.rta = true, .near_first = true};
constexpr TraversalOptions kWithoutRta = {.rta = false, .near_first = true};
constexpr TraversalOptions kWoop = {.rta = true, .near_first = true, .tests = TestKind::Woop};

Combination speculative(const TraversalOptions& options, Distribution distribution) {
    return {StructureKind::Binned, TraversalKind::Speculative, options, distribution};
}
Combination packet(const TraversalOptions& options, Distribution distribution) {
    return {StructureKind::Binned, TraversalKind::Packet, options, distribution};
}

bool on_cuda(const ThesisReport& thesis) { return !thesis.scenes.empty() && thesis.scenes.front().device != "CPU"; }

const CombinationFigures* find(const LabReport& report, const Combination& wanted) {
    const std::string name = name_of(wanted);
    const auto at =
        std::ranges::find_if(report.combinations, [&](const CombinationFigures& c) { return c.name == name; });
    return at == report.combinations.end() ? nullptr : &*at;
}

/// Seconds per frame at this depth; absent if the variant was not measured there.
std::optional<double> seconds_of(const LabReport& report, const ThesisVariant& v, int depth) {
    const CombinationFigures* c = find(report, v.combination);
    return c != nullptr && !c->wrong ? frame_seconds(report, *c, depth) : std::nullopt;
}

using Names = std::vector<std::string>;

/// The variants of these names that this kind of device has, in the order of thesis_variants().
std::vector<ThesisVariant> variants_named(const Names& names, bool is_cuda) {
    std::vector<ThesisVariant> variants = thesis_variants(is_cuda);
    std::erase_if(variants, [&](const ThesisVariant& v) { return std::ranges::find(names, v.name) == names.end(); });
    return variants;
}

/// A row for each depth with frames per second, seconds per frame and Mrays/s of each variant. With several reports
/// each row begins with the scene.
ResultTable depth_table(std::span<const LabReport> reports, std::string name, std::string title,
                        const std::vector<ThesisVariant>& variants) {
    ResultTable table = {std::move(name), std::move(title)};
    if (reports.size() > 1) table.columns.push_back({"scene", "scene", "", ""});
    table.columns.push_back({"depth", "depth", "", ""});
    for (const ThesisVariant& v : variants) {
        table.columns.push_back({fmt::format("{}_frames_per_second", v.name), v.name, "frames/s", "{:.2f}"});
        table.columns.push_back({fmt::format("{}_seconds", v.name), v.name, "s", "{:.5f}"});
        table.columns.push_back({fmt::format("{}_mrays", v.name), v.name, "Mrays/s", "{:.2f}"});
    }
    for (const LabReport& report : reports) {
        for (int depth = report.first_depth; depth <= largest_depth(report); ++depth) {
            std::vector<ResultCell>& row = table.rows.emplace_back();
            if (reports.size() > 1) row.emplace_back(report.scene);
            row.emplace_back(depth);
            for (const ThesisVariant& v : variants) {
                const CombinationFigures* c = find(report, v.combination);
                if (const std::optional<double> seconds = seconds_of(report, v, depth)) {
                    const double rays = static_cast<double>(frame_rays(report, depth));
                    row.insert(row.end(), {1 / *seconds, *seconds, rays / *seconds * 1e-6});
                } else {
                    row.insert(row.end(), 3, c != nullptr && c->wrong ? ResultCell("WRONG") : ResultCell());
                }
            }
        }
    }
    return table;
}

/// Tables in the order of the thesis's captions, followed by the data of its figures that no table contains.
std::vector<ResultTable> tables_of(const ThesisReport& thesis) {
    const bool is_cuda = on_cuda(thesis);
    const char* const both_ways =
        is_cuda ? "with and without persistent threads" : "without persistent threads, which a CPU has not got";
    const char* const without_rta = is_cuda ? "with persistent threads and without RTA"
                                            : "without RTA, and without persistent threads, which a CPU has not got";
    const Names of_table_5 = is_cuda ? Names{"PSWW-R", "PPacket-R"} : Names{"SWW-R", "Packet-R"};
    std::vector<ResultTable> tables, beside;
    for (std::size_t i = 0; i < thesis.scenes.size(); ++i) {
        const std::span<const LabReport> report(&thesis.scenes[i], 1);
        const std::string& scene = report[0].scene;
        tables.push_back(depth_table(report, fmt::format("table-6.{}", 3 + i),
                                     fmt::format("Table 6.{}: {} {}", 3 + i, scene, both_ways),
                                     variants_named({"SWW", "PSWW", "Packet", "PPacket"}, is_cuda)));
        std::vector<ThesisVariant> rest = variants_named({"SWW-R", "PSWW-R", "Packet-R", "PPacket-R"}, is_cuda);
        if (i > 0) {
            tables.push_back(depth_table(report, "table-6.5", fmt::format("Table 6.5: {} {}", scene, without_rta),
                                         variants_named(of_table_5, is_cuda)));
            std::erase_if(rest, [&](const ThesisVariant& v) {
                return std::ranges::find(of_table_5, v.name) != of_table_5.end();
            });
        }
        const std::string title = fmt::format("Figures 6.9 to 6.11 beside: {} without RTA", scene);
        if (!rest.empty()) beside.push_back(depth_table(report, fmt::format("beside-{}", i + 1), title, rest));
    }
    if (!thesis.scenes.empty()) {
        const LabReport& one = thesis.scenes.front();
        tables.push_back(
            depth_table(thesis.scenes, "table-6.6",
                        fmt::format("Table 6.6: {} at {}x{} against Aila and Laine's kernel (A)",
                                    thesis.scenes.size() > 1 ? "both scenes" : one.scene, one.width, one.height),
                        variants_named({"SWW", "PSWW", "Packet", "PPacket", "A"}, is_cuda)));
    }
    tables.insert(tables.end(), beside.begin(), beside.end());
    return tables;
}

/// Why a variant lacks some or all figures; empty if it has them.
std::string missing(const LabReport& report, const ThesisVariant& v) {
    const CombinationFigures* c = find(report, v.combination);
    if (c == nullptr) return "it is not in the report";
    if (c->wrong) return c->refused.starts_with("WRONG") ? c->refused : "WRONG: " + c->refused;
    if (!c->refused.empty()) return c->refused;
    for (int depth = report.first_depth; depth <= largest_depth(report); ++depth) {
        if (frame_seconds(report, *c, depth)) continue;
        return report.interrupted ? fmt::format("interrupted before depth {}", depth)
                                  : fmt::format("not timed at depth {}", depth);
    }
    return {};
}

/// Lines below the tables: interruptions, missing figures, and hits that inexact tests miss.
std::vector<std::string> notes_of(const ThesisReport& thesis) {
    std::vector<std::string> notes;
    for (const std::string& line : thesis.lacking) notes.push_back("Not made: " + line);
    for (const LabReport& report : thesis.scenes) {
        if (report.interrupted) {
            notes.push_back(fmt::format("{}: interrupted; this is what had been measured.", report.scene));
        }
        for (const ThesisVariant& v : thesis_variants(on_cuda(thesis))) {
            const std::string why = missing(report, v);
            if (!why.empty()) notes.push_back(fmt::format("{}, {}: {}", report.scene, v.name, why));
            const CombinationFigures* c = find(report, v.combination);
            if (v.combination.options.is_exact() || c == nullptr) continue;
            for (const RunFigures& run : c->runs) {
                const SetFigures& set = report.sets[run.set];
                notes.push_back(fmt::format("{}, {}: {} of {} {} rays differ from the exact result.", report.scene,
                                            v.name, run.different, set.rays, set.name));
            }
        }
    }
    if (thesis.scenes.empty()) notes.emplace_back("Nothing was measured.");
    if (thesis.scenes.size() == 1 && thesis.lacking.empty()) notes.emplace_back("The second scene was not measured.");
    return notes;
}

ResultTable frames_of(const ThesisReport& thesis) {
    ResultTable table = {"frames", "Frames over the depth of paths"};
    for (const LabReport& report : thesis.scenes) {
        for (const ThesisVariant& v : thesis_variants(on_cuda(thesis))) {
            for (int depth = report.first_depth; depth <= largest_depth(report); ++depth) {
                const std::optional<double> seconds = seconds_of(report, v, depth);
                if (!seconds) continue;
                table.add({{"scene", "scene", report.scene},
                           {"variant", "variant", v.name},
                           {"series", "series", fmt::format("{}: {}", report.scene, v.name)},
                           {"depth", "depth", depth},
                           {"frames_per_second", "frames/s", 1 / *seconds},
                           {"seconds", "frame", *seconds, "s"},
                           {"mrays", "Mrays/s", static_cast<double>(frame_rays(report, depth)) / *seconds * 1e-6}});
            }
        }
    }
    return table;
}

ResultTable scenes_of(const ThesisReport& thesis) {
    ResultTable table = {"scenes", "Scenes"};
    for (const LabReport& r : thesis.scenes) {
        table.add({{"scene", "scene", r.scene},
                   {"triangles", "triangles", r.triangles},
                   {"width", "width", r.width},
                   {"height", "height", r.height},
                   {"runs", "runs", r.runs},
                   {"warm_ups", "for warming up", r.warm_ups},
                   {"device", "device", r.device},
                   {"camera", "camera", r.camera}});
    }
    return table;
}

bool is_rendered(const ThesisPicture& picture) { return picture.stats.samples > 0; }

/// A picture's caption: what it shows, how it was made, and how long that took.
std::string caption_of(const ThesisPicture& picture) {
    std::string text = picture.shows;
    if (is_rendered(picture)) {
        const std::string solved =
            picture.solve_seconds > 0 ? fmt::format("solved in {} s, ", fixed_text(picture.solve_seconds, 2)) : "";
        text += fmt::format(" Integrator {}, {}{} sample{} a pixel in {} s{}.", picture.integrator, solved,
                            picture.stats.samples, picture.stats.samples == 1 ? "" : "s",
                            fixed_text(picture.stats.render_seconds, 2), picture.interrupted ? " (interrupted)" : "");
    }
    return text + (picture.command.empty() ? " Made by the laboratory alone." : " Made by: " + picture.command);
}

} // namespace

std::vector<ThesisVariant> thesis_variants(bool is_cuda) {
    using enum Distribution;
    if (!is_cuda) {
        return {{"SWW", "speculative while-while; on a CPU no lanes wait for each other, so it is plain while-while",
                 speculative(kWithRta, OneAThread)},
                {"SWW-R", "the same without RTA", speculative(kWithoutRta, OneAThread)},
                {"Packet", "eight rays share a stack", packet(kWithRta, OneAThread)},
                {"Packet-R", "the same without RTA", packet(kWithoutRta, OneAThread)},
                {"A",
                 "SWW with Aila and Laine's triangle test, Woop's unit-triangle transform, and boxes without growth, "
                 "which lose rays at edges; their dynamic fetch needs a GPU",
                 speculative(kWoop, OneAThread)}};
    }
    return {{"SWW", "speculative while-while, one ray a thread", speculative(kWithRta, OneAThread)},
            {"SWW-R", "the same without RTA", speculative(kWithoutRta, OneAThread)},
            {"PSWW", "persistent threads", speculative(kWithRta, Persistent)},
            {"PSWW-R", "the same without RTA", speculative(kWithoutRta, Persistent)},
            {"PPacket", "persistent packets: a warp shares a stack", packet(kWithRta, Persistent)},
            {"PPacket-R", "the same without RTA", packet(kWithoutRta, Persistent)},
            {"A",
             "Aila and Laine's kernel: speculative while-while with dynamic fetch, Woop's unit-triangle transform and "
             "boxes without growth, which lose rays at edges",
             speculative(kWoop, DynamicFetch)}};
}

ResultTable table_of(std::span<const ThesisPicture> pictures) {
    ResultTable table = {"pictures", "Pictures of chapters 2 to 4"};
    for (const ThesisPicture& p : pictures) {
        const bool has_pixels = p.svg.empty(), rendered = is_rendered(p);
        const double seconds = std::max(p.stats.render_seconds, 1e-9), rays = static_cast<double>(p.stats.rays.total());
        table.add({{"file", "picture", p.file()},
                   {"place", "", p.place},
                   {"title", "", p.title},
                   {"shows", "", p.shows},
                   {"integrator", "integrator", if_not_empty(p.integrator)},
                   {"command", "", if_not_empty(p.command)},
                   {"width", "width", has_pixels ? ResultCell(p.image.width) : ResultCell()},
                   {"height", "height", has_pixels ? ResultCell(p.image.height) : ResultCell()},
                   {"samples", "samples", rendered ? ResultCell(p.stats.samples) : ResultCell()},
                   {"solve_seconds", "solved in", if_timed(p.solve_seconds), "s", "{:.3f}"},
                   {"render_seconds", "rendered in", rendered ? ResultCell(p.stats.render_seconds) : ResultCell(), "s",
                    "{:.3f}"},
                   {"rays", "", rendered ? ResultCell(p.stats.rays.total()) : ResultCell()},
                   {"interrupted", "interrupted", p.interrupted},
                   {"frames_per_second", "one sample", rendered ? ResultCell(p.stats.samples / seconds) : ResultCell(),
                    "frames/s", "{:.2f}"},
                   {"mrays", "Mrays/s", rendered && rays > 0 ? ResultCell(rays / seconds * 1e-6) : ResultCell(), "",
                    "{:.2f}"}});
    }
    return table;
}

Measurement measurement_of(const ThesisReport& thesis, Measurement m) {
    m.kind = "thesis";
    m.title = fmt::format("Bellek 2014, Realtime photo-realistic rendering using modern GPU systems: {} made anew",
                          thesis.pictures.empty() ? "chapter 6" : "chapters 2 to 4 and 6");
    ResultTable variants = {"variants", "Variants"}, lacking = {"lacking", "Not made"};
    for (const ThesisVariant& v : thesis_variants(on_cuda(thesis))) {
        variants.add({{"name", "variant", v.name}, {"meaning", "meaning", v.meaning}});
    }
    for (const std::string& line : thesis.lacking) lacking.add({{"what", "what, and why", line}});
    m.tables = {variants, lacking, scenes_of(thesis)};
    for (ResultTable& table : tables_of(thesis)) m.tables.push_back(std::move(table));
    m.tables.push_back(frames_of(thesis));
    m.tables.push_back(table_of(thesis.pictures));
    m.notes = notes_of(thesis);
    m.notes.emplace_back(kTree);
    for (const ThesisPicture& p : thesis.pictures) {
        m.pictures.push_back({.group = fmt::format("{}: {}", p.place, p.title),
                              .title = p.name,
                              .caption = caption_of(p),
                              .image = p.image,
                              .svg = p.svg,
                              .file = p.file()});
    }
    m.pictures.insert(m.pictures.end(), thesis.local_and_global.begin(), thesis.local_and_global.end());
    return m;
}

std::string text_of(const ThesisReport& thesis) {
    std::string text;
    for (const ThesisVariant& v : thesis_variants(on_cuda(thesis))) {
        text += fmt::format("{:10} {}\n", v.name, v.meaning);
    }
    text += fmt::format("{}\n", kTree);
    std::vector<ResultTable> tables = tables_of(thesis);
    if (!thesis.pictures.empty()) tables.push_back(table_of(thesis.pictures));
    for (const ResultTable& table : tables) text += '\n' + table.title + '\n' + text_of(table);
    text += '\n';
    for (const std::string& note : notes_of(thesis)) text += note + '\n';
    return text;
}

} // namespace pertev
