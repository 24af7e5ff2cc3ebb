#include "lab/thesis.h"

#include <algorithm>

#include <fmt/format.h>

#include "lab/lab_tables.h"

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
    const auto at = std::ranges::find(report.combinations, name_of(wanted), &CombinationFigures::name);
    return at == report.combinations.end() ? nullptr : &*at;
}

/// Returns notes: on what is missing, those of each scene, and the number of hits that inexact tests miss.
std::vector<std::string> notes_of(const ThesisReport& thesis) {
    std::vector<std::string> notes;
    for (const std::string& line : thesis.lacking) notes.push_back("Not made: " + line);
    for (const LabReport& report : thesis.scenes) {
        for (const std::string& note : measurement_of(report).notes) notes.push_back(report.scene + ": " + note);
        if (report.interrupted) notes.push_back(report.scene + ": interrupted; the results are incomplete.");
        for (const CombinationFigures& c : report.combinations) {
            if (c.combination.options.is_exact()) continue;
            for (const RunFigures& run : c.runs) {
                const SetFigures& set = report.sets[run.set];
                notes.push_back(fmt::format("{}, A: {} of {} {} rays differ from the exact result.", report.scene,
                                            run.different, set.rays, set.name));
            }
        }
    }
    if (thesis.scenes.empty()) notes.emplace_back("Nothing was measured.");
    notes.emplace_back(kTree);
    return notes;
}

ResultTable frames_of(const ThesisReport& thesis) {
    ResultTable table = {"frames", "Frames over the depth of paths"};
    for (const LabReport& report : thesis.scenes) {
        for (const ThesisVariant& v : thesis_variants(on_cuda(thesis))) {
            for (int depth = report.first_depth; depth <= largest_depth(report); ++depth) {
                const CombinationFigures* c = find(report, v.combination);
                const auto seconds = c != nullptr && !c->wrong ? frame_seconds(report, *c, depth) : std::nullopt;
                if (!seconds) continue;
                table.add({{"number", "", &report == thesis.scenes.data() ? 1 : 2},
                           {"scene", "scene", report.scene},
                           {"variant", "variant", v.name},
                           {"series", "series", fmt::format("{}: {}", report.scene, v.name)},
                           {"depth", "depth", depth},
                           {"frames_per_second", "frames/s", 1 / *seconds, "", "{:.2f}"},
                           {"seconds", "frame", *seconds, "s", "{:.5f}"},
                           {"mrays", "Mrays/s", static_cast<double>(frame_rays(report, depth)) / *seconds * 1e-6, "",
                            "{:.2f}"}});
            }
        }
    }
    return table;
}

ResultTable scenes_of(const ThesisReport& thesis) {
    ResultTable table = {"scenes", "Scenes"};
    for (const LabReport& report : thesis.scenes) {
        const ResultTable one = measurement_of(report).table("scene");
        table.columns = one.columns;
        table.rows.push_back(one.rows.front());
    }
    return table;
}

bool is_rendered(const ThesisPicture& picture) { return picture.stats.samples > 0; }

/// Returns a picture's caption: what it shows, how it was made, and how long that took.
std::string caption_of(const ThesisPicture& picture) {
    std::string text = picture.shows;
    if (is_rendered(picture)) {
        const std::string solved =
            picture.solve_seconds > 0 ? fmt::format("solved in {:.3g} s, ", picture.solve_seconds) : "";
        text += fmt::format(" Integrator {}, {}{} sample{} per pixel in {:.3g} s{}.", picture.integrator, solved,
                            picture.stats.samples, picture.stats.samples == 1 ? "" : "s", picture.stats.render_seconds,
                            picture.interrupted ? " (interrupted)" : "");
    }
    return text + (picture.command.empty() ? " Made by the laboratory alone." : " Made by: " + picture.command);
}

} // namespace

std::vector<ThesisVariant> thesis_variants(bool is_cuda) {
    using enum Distribution;
    if (!is_cuda) {
        return {{"SWW", "speculative while-while; on a CPU no lanes wait for each other, so it is plain while-while",
                 speculative(kWithRta, OneAThread)},
                {"SWW-R", "the column before without RTA", speculative(kWithoutRta, OneAThread)},
                {"Packet", "eight rays share a stack", packet(kWithRta, OneAThread)},
                {"Packet-R", "the column before without RTA", packet(kWithoutRta, OneAThread)},
                {"A",
                 "SWW with Aila and Laine's triangle test, Woop's unit-triangle transform, and boxes without growth, "
                 "which lose rays at edges; their dynamic fetch needs a GPU",
                 speculative(kWoop, OneAThread)}};
    }
    return {{"SWW", "speculative while-while, one ray a thread", speculative(kWithRta, OneAThread)},
            {"SWW-R", "the column before without RTA", speculative(kWithoutRta, OneAThread)},
            {"PSWW", "persistent threads", speculative(kWithRta, Persistent)},
            {"PSWW-R", "the column before without RTA", speculative(kWithoutRta, Persistent)},
            {"PPacket", "persistent packets: a warp shares a stack", packet(kWithRta, Persistent)},
            {"PPacket-R", "the column before without RTA", packet(kWithoutRta, Persistent)},
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
    m.title = fmt::format("Bellek 2014, Realtime photo-realistic rendering using modern GPU systems: {} repeated",
                          thesis.pictures.empty() ? "chapter 6" : "chapters 2 to 4 and 6");
    ResultTable variants = {"variants", "Variants"}, lacking = {"lacking", "Not made"};
    for (const ThesisVariant& v : thesis_variants(on_cuda(thesis))) {
        variants.add({{"name", "variant", v.name}, {"meaning", "meaning", v.meaning}});
    }
    for (const std::string& line : thesis.lacking) lacking.add({{"what", "part and reason", line}});
    m.tables = {variants, lacking, scenes_of(thesis), frames_of(thesis), table_of(thesis.pictures)};
    m.notes = notes_of(thesis);
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
    text += '\n' + text_of(frames_of(thesis)) + '\n';
    if (!thesis.pictures.empty()) text += text_of(table_of(thesis.pictures)) + '\n';
    for (const std::string& note : notes_of(thesis)) text += note + '\n';
    return text;
}

} // namespace pertev
