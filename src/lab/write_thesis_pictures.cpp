#include "lab/write_thesis_pictures.h"

#include <algorithm>

#include <fmt/format.h>

#include "base/json_text.h"
#include "lab/csv_line.h"
#include "lab/svg_plot.h"
#include "lab/text_table.h"
#include "lab/write_html.h"

namespace pertev {
namespace {

constexpr uint32_t kWholeWidth = 512;

/// 2 of "Figure 2.1".
char chapter_of(const ThesisPicture& picture) { return picture.place[picture.place.find(' ') + 1]; }

bool is_rendered(const ThesisPicture& picture) { return picture.stats.samples > 0; }

/// Beneath a picture: what it shows, how it was made, in which time.
std::string caption_of(const ThesisPicture& picture) {
    std::string text = picture.shows;
    if (is_rendered(picture)) {
        const char* plural = picture.stats.samples == 1 ? "" : "s";
        const std::string solved =
            picture.solve_seconds > 0 ? fmt::format("solved in {} s, ", fixed_text(picture.solve_seconds, 2)) : "";
        text += fmt::format(" Integrator {}, {}{} sample{} a pixel in {} s{}.", picture.integrator, solved,
                            picture.stats.samples, plural, fixed_text(picture.stats.render_seconds, 2),
                            picture.interrupted ? " (interrupted)" : "");
    }
    return text + (picture.command.empty() ? " Made by the laboratory alone." : " Made by: " + picture.command);
}

std::string html_of(const ThesisPicture& picture) {
    const std::string caption = caption_of(picture);
    if (picture.svg.empty()) return html_image(picture.image, caption, kWholeWidth);
    return fmt::format("<figure>{}<figcaption>{}</figcaption></figure>\n", picture.svg, html_text(caption));
}

/// Whether the two stand side by side.
bool are_together(const ThesisPicture& a, const ThesisPicture& b) { return a.place == b.place && a.title == b.title; }

} // namespace

std::vector<std::vector<std::string>> table_of(std::span<const ThesisPicture> pictures) {
    std::vector<std::vector<std::string>> rows = {{"picture", "integrator", "size", "samples", "solved in s",
                                                   "rendered in s", "frames/s of one sample", "Mrays/s"}};
    for (const ThesisPicture& picture : pictures) {
        if (!is_rendered(picture)) continue;
        const double seconds = std::max(picture.stats.render_seconds, 1e-9);
        rows.push_back({picture.name, picture.integrator,
                        fmt::format("{}x{}", picture.image.width, picture.image.height),
                        fmt::format("{}{}", picture.stats.samples, picture.interrupted ? " (interrupted)" : ""),
                        picture.solve_seconds > 0 ? fixed_text(picture.solve_seconds, 3) : "", fixed_text(seconds, 3),
                        fixed_text(picture.stats.samples / seconds, 2),
                        picture.stats.rays.total() > 0
                            ? fixed_text(static_cast<double>(picture.stats.rays.total()) / seconds * 1e-6, 2)
                            : ""});
    }
    return rows;
}

std::string html_of(std::span<const ThesisPicture> pictures) {
    std::string html;
    for (std::size_t i = 0; i < pictures.size(); ++i) {
        const ThesisPicture& picture = pictures[i];
        if (i == 0 || chapter_of(pictures[i - 1]) != chapter_of(picture)) {
            html += fmt::format("<h2>Chapter {}</h2>\n", chapter_of(picture));
        }
        if (i == 0 || !are_together(pictures[i - 1], picture)) {
            html += fmt::format("<h3>{}: {}</h3>\n", html_text(picture.place), html_text(picture.title));
        }
        html += html_of(picture);
    }
    return html;
}

std::string csv_of(std::span<const ThesisPicture> pictures) {
    std::string csv = csv_line({"file", "place", "title", "shows", "integrator", "command", "width", "height",
                                "samples", "solve_seconds", "render_seconds", "rays", "interrupted"});
    for (const ThesisPicture& picture : pictures) {
        const auto where = [&](bool is_there, const std::string& text) { return is_there ? text : std::string(); };
        const bool has_pixels = picture.svg.empty(), rendered = is_rendered(picture);
        csv +=
            csv_line({picture.file(), picture.place, picture.title, picture.shows, picture.integrator, picture.command,
                      where(has_pixels, fmt::format("{}", picture.image.width)),
                      where(has_pixels, fmt::format("{}", picture.image.height)),
                      where(rendered, fmt::format("{}", picture.stats.samples)),
                      where(picture.solve_seconds > 0, fmt::format("{:.6f}", picture.solve_seconds)),
                      where(rendered, fmt::format("{:.6f}", picture.stats.render_seconds)),
                      where(rendered, fmt::format("{}", picture.stats.rays.total())), picture.interrupted ? "1" : "0"});
    }
    return csv;
}

std::string json_of(std::span<const ThesisPicture> pictures) {
    std::string list;
    for (const ThesisPicture& picture : pictures) {
        const auto text = [](const std::string& value) { return value.empty() ? "null" : json_string(value); };
        const auto where = [](bool is_there, const std::string& number) { return is_there ? number : "null"; };
        const bool has_pixels = picture.svg.empty(), rendered = is_rendered(picture);
        list += fmt::format(
            R"({}{{"file":{},"place":{},"title":{},"shows":{},"integrator":{},"command":{},"width":{},"height":{},"samples":{},"solve_seconds":{},"render_seconds":{},"rays":{},"interrupted":{}}})",
            list.empty() ? "" : ",", json_string(picture.file()), json_string(picture.place),
            json_string(picture.title), json_string(picture.shows), text(picture.integrator), text(picture.command),
            where(has_pixels, fmt::format("{}", picture.image.width)),
            where(has_pixels, fmt::format("{}", picture.image.height)),
            where(rendered, fmt::format("{}", picture.stats.samples)),
            where(picture.solve_seconds > 0, json_number(picture.solve_seconds)),
            where(rendered, json_number(picture.stats.render_seconds)),
            where(rendered, fmt::format("{}", picture.stats.rays.total())), picture.interrupted);
    }
    return '[' + list + ']';
}

} // namespace pertev
