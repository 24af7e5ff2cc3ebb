#include "lab/write_html.h"

#include <algorithm>

#include <fmt/format.h>

#include "image/write_png.h"
#include "lab/heat_map.h"
#include "lab/svg_plot.h"

namespace pertev {
namespace {

constexpr std::size_t kCurves = 10;

constexpr const char* kStyle =
    "body{font:14px/1.45 sans-serif;margin:2em auto;max-width:1100px;padding:0 1em;color:#222}"
    "table{border-collapse:collapse;font-size:12px;margin:1em 0;display:block;overflow-x:auto}"
    "th,td{border:1px solid #ccc;padding:2px 6px;text-align:right;white-space:nowrap}"
    "th:first-child,td:first-child{text-align:left}th{background:#f3f3f3}"
    "figure{display:inline-block;margin:.5em}figcaption{font-size:12px}svg{max-width:100%;height:auto}";

/// RFC 4648, section 4.
std::string base64(const std::vector<std::byte>& bytes) {
    constexpr char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string text;
    text.reserve((bytes.size() + 2) / 3 * 4);
    for (std::size_t i = 0; i < bytes.size(); i += 3) {
        const auto at = [&](std::size_t k) { return k < bytes.size() ? std::to_integer<uint32_t>(bytes[k]) : 0u; };
        const uint32_t bits = at(i) << 16 | at(i + 1) << 8 | at(i + 2);
        for (std::size_t k = 0; k < 4; ++k) text += i + k <= bytes.size() ? digits[bits >> (18 - 6 * k) & 63] : '=';
    }
    return text;
}

std::string cell(const std::string& text) { return "<td>" + html_text(text) + "</td>"; }
/// Empty where there is no figure.
std::string figure(double value, const char* format) {
    return cell(value > 0 ? fmt::format(fmt::runtime(format), value) : "");
}

std::string structures_table(const LabReport& report) {
    std::string rows;
    for (const StructureFigures& s : report.structures) {
        if (!s.failed.empty()) {
            rows += fmt::format("<tr>{}<td colspan=\"6\">{}</td></tr>\n", cell(s.name), html_text(s.failed));
            continue;
        }
        const double bytes = static_cast<double>(s.bytes);
        rows += "<tr>" + cell(s.name) + figure(s.build_s, "{:.3f}") + cell(fmt::format("{}", s.nodes)) +
                cell(fmt::format("{}", s.triangles)) + figure(bytes / 1048576.0, "{:.2f}") +
                figure(bytes / static_cast<double>(std::max<uint64_t>(report.triangles, 1)), "{:.1f}") +
                figure(s.sah_cost, "{:.2f}") + cell(fmt::format("{}", s.depth)) + "</tr>\n";
    }
    return "<table><tr><th>structure</th><th>build, s</th><th>nodes</th><th>triangles in leaves</th><th>MiB</th>"
           "<th>bytes a triangle</th><th>SAH cost</th><th>depth</th></tr>\n" +
           rows + "</table>\n";
}

std::string combinations_table(const LabReport& report) {
    std::string rows;
    for (const CombinationFigures& c : report.combinations) {
        for (const RunFigures& run : c.runs) {
            const SetFigures& set = report.sets[run.set];
            const double frame_s = set.depth > 0 ? frame_seconds(report, c, set.depth) : 0;
            const double spread = run.median_s > 0 ? 100 * (run.largest_s - run.least_s) / run.median_s : 0;
            rows += "<tr>" + cell(c.name) + cell(set.name) + figure(mrays(report, run), "{:.2f}") +
                    figure(spread, "{:.1f} %") + figure(frame_s > 0 ? 1 / frame_s : 0, "{:.2f}") +
                    figure(frame_s, "{:.5f}") + figure(run.nodes, "{:.2f}") + figure(run.triangles, "{:.2f}") +
                    figure(run.node_lanes, "{:.1f}") + figure(run.triangle_lanes, "{:.1f}") +
                    figure(run.sectors, "{:.1f}") + figure(c.registers, "{:.0f}") +
                    figure(100 * c.occupancy, "{:.0f} %") +
                    cell(run.different > 0 ? fmt::format("{}", run.different) : "") + "</tr>\n";
        }
    }
    return "<table><tr><th>combination</th><th>rays</th><th>Mrays/s</th><th>spread</th><th>frames/s</th><th>s/frame"
           "</th><th>nodes a ray</th><th>triangles a ray</th><th>lanes, nodes</th><th>lanes, triangles</th><th>sectors"
           "</th><th>registers</th><th>occupancy</th><th>rays that differ</th></tr>\n" +
           rows + "</table>\n";
}

std::string refused_list(const LabReport& report) {
    std::string items;
    for (const CombinationFigures& c : report.combinations) {
        if (!c.refused.empty()) items += fmt::format("<li>{}: {}</li>\n", html_text(c.name), html_text(c.refused));
    }
    return items.empty() ? "" : "<h2>Not run</h2><ul>\n" + items + "</ul>\n";
}

std::string bars_of(const LabReport& report, uint32_t set) {
    std::vector<Bar> bars;
    for (const CombinationFigures& c : report.combinations) {
        for (const RunFigures& run : c.runs) {
            if (run.set != set || !(run.least_s > 0)) continue;
            const double rays = static_cast<double>(report.sets[set].rays) * 1e-6;
            bars.push_back({c.name, rays / run.median_s, rays / run.largest_s, rays / run.least_s});
        }
    }
    std::ranges::stable_sort(bars, [](const Bar& a, const Bar& b) { return a.value > b.value; });
    return svg_bars(report.sets[set].name, "Mrays/s", bars);
}

std::string curves_over_depth(const LabReport& report) {
    const int depths = largest_depth(report);
    if (depths <= report.first_depth) return {};
    std::vector<const CombinationFigures*> complete;
    for (const CombinationFigures& c : report.combinations) {
        if (frame_seconds(report, c, depths) > 0) complete.push_back(&c);
    }
    std::ranges::stable_sort(complete, [&](const CombinationFigures* a, const CombinationFigures* b) {
        return frame_seconds(report, *a, depths) < frame_seconds(report, *b, depths);
    });
    complete.resize(std::min(complete.size(), kCurves));
    std::vector<Curve> rates, frames;
    for (const CombinationFigures* c : complete) {
        Curve rate = {c->name, {}}, frame = {c->name, {}};
        for (int depth = report.first_depth; depth <= depths; ++depth) {
            const double seconds = frame_seconds(report, *c, depth);
            frame.points.emplace_back(depth, 1 / seconds);
            rate.points.emplace_back(depth, static_cast<double>(frame_rays(report, depth)) / seconds * 1e-6);
        }
        rates.push_back(rate), frames.push_back(frame);
    }
    return svg_curves("Rays a second over the depth of paths, the ten fastest", "depth", "Mrays/s", rates) +
           svg_curves("Frames a second over the depth of paths, the ten fastest", "depth", "frames/s", frames);
}

std::string heat_maps_of(const LabReport& report) {
    if (report.heat_maps.empty()) return {};
    // One scale for all, so that pictures can be compared.
    uint32_t most_nodes = 1, most_triangles = 1;
    for (const HeatMap& map : report.heat_maps) {
        most_nodes = std::max(most_nodes, scale_end(map.nodes));
        most_triangles = std::max(most_triangles, scale_end(map.triangles));
    }
    std::string html = "<h2>Tests a pixel, camera rays</h2>\n";
    for (const HeatMap& map : report.heat_maps) {
        html += html_image(draw_heat_map(map.nodes, map.width, map.height, most_nodes), map.name + ": nodes", 512);
        html += html_image(draw_heat_map(map.triangles, map.width, map.height, most_triangles),
                           map.name + ": triangles", 512);
    }
    return html;
}

} // namespace

std::string html_page(const std::string& title, const std::string& body) {
    return fmt::format("<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><title>{0}</title>\n"
                       "<style>{1}</style></head>\n<body><h1>{0}</h1>\n{2}</body></html>\n",
                       html_text(title), kStyle, body);
}

std::string html_image(const Rgba8Image& image, const std::string& caption, uint32_t shown_width) {
    return fmt::format("<figure><img width=\"{}\" alt=\"{}\" src=\"data:image/png;base64,{}\"><figcaption>{}"
                       "</figcaption></figure>\n",
                       std::min(shown_width, image.width), html_text(caption), base64(encode_png(image)),
                       html_text(caption));
}

std::string html_of(const LabReport& report) {
    std::string body = fmt::format(
        "<p>{} triangles, {} instances; {}; pertev {}. Camera rays: {} x {}. Each set of rays was traced {} times "
        "after "
        "{} for warming up; figures are medians, whiskers reach from the slowest run to the fastest. Every combination "
        "gave the hits of the proven walk bit for bit before it was timed, on all of its rays; those with fast tests "
        "are exempt, and how many of their rays differ is a column.{}</p>\n",
        report.triangles, report.instances, html_text(report.device), html_text(report.commit), report.width,
        report.height, report.runs, report.warm_ups,
        report.interrupted ? " <strong>Interrupted: what follows is what had been measured.</strong>" : "");
    body += "<h2>Structures</h2>\n" + structures_table(report);
    body += "<h2>Million rays a second</h2>\n";
    for (uint32_t set = 0; set < report.sets.size(); ++set) body += bars_of(report, set);
    body += curves_over_depth(report);
    body +=
        "<h2>All figures</h2>\n<p>A frame of depth d is one camera ray a pixel and its d - 1 diffuse bounces. Lanes: "
        "live ones of 32 at a test; sectors: of 32 bytes, a warp's node load. An empty cell was not measured "
        "there.</p>\n" +
        combinations_table(report) + refused_list(report) + heat_maps_of(report);
    for (const Picture& picture : report.pictures) body += html_image(picture.image, picture.caption, 1024);
    return html_page("Pertev traversal laboratory: " + report.scene, body);
}

} // namespace pertev
