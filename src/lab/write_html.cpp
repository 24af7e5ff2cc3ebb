#include "lab/write_html.h"

#include <algorithm>

#include <fmt/format.h>

#include "image/write_png.h"
#include "lab/html_plots.h"
#include "lab/html_tables.h"
#include "lab/svg_plot.h"

namespace pertev {
namespace {

constexpr const char* kStyle =
    "body{font:14px/1.45 sans-serif;margin:2em auto;max-width:1100px;padding:0 1em;color:#222}"
    "table{border-collapse:collapse;font-size:12px;margin:1em 0;display:block;overflow-x:auto}"
    "th,td{border:1px solid #ccc;padding:2px 6px;text-align:right;white-space:nowrap}"
    ".wrong{color:#b00}th:first-child,td:first-child{text-align:left}th{background:#f3f3f3}"
    "figure{display:inline-block;width:min-content;vertical-align:top;margin:.5em}figcaption{font-size:12px}"
    "svg{max-width:100%;height:auto}figure svg{max-width:none}";

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

std::string depths_of(const LabReport& report) {
    const int last = largest_depth(report);
    if (last < 1) return {};
    return last <= report.first_depth ? fmt::format("; paths of depth {}", last)
                                      : fmt::format("; paths of depths {} to {}", report.first_depth, last);
}

std::string head_of(const LabReport& report) {
    const auto item = [](const char* name, const std::string& text) {
        return text.empty() ? "" : fmt::format("<li>{}: {}</li>\n", name, html_text(text));
    };
    const std::string timing = fmt::format("{} runs of each set after {} for warming up", report.runs, report.warm_ups);
    return "<ul>\n" +
           item("Scene",
                fmt::format("{}; {} triangles, {} instances", report.scene, report.triangles, report.instances)) +
           item("Camera", report.camera) +
           item("Size", fmt::format("{} x {}{}", report.width, report.height, depths_of(report))) +
           item("Device", report.device) +
           item("Threads of the CPU", report.threads > 0 ? fmt::format("{}", report.threads) : "") +
           item("Pertev", report.commit) + item("Timing", report.runs > 0 ? timing : "none: checked alone") + "</ul>\n";
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
    std::string body = html_wrong(report);
    if (report.interrupted) {
        body += "<p class=\"wrong\">Interrupted: what follows is what had been measured.</p>\n";
    }
    body += head_of(report);
    body +=
        "<p>One walk (while-while over the binned tree, the <em>proven walk</em>) is held against brute force: a test "
        "of each triangle. Every combination with figures gave its hits bit for bit, on all of its rays, before it was "
        "timed; those with fast or Woop's tests are exempt, and how many of their rays differ is a column.</p>\n";
    body += "<h2>Rays</h2>\n" + html_sets(report) + "<h2>Structures</h2>\n" + html_structures(report);
    body += html_matrices(report) + html_bars(report) + html_curves(report) + html_ratios(report);
    body += html_figures(report) + html_not_run(report) + html_heat_maps(report);
    return html_page("Pertev traversal laboratory: " + report.scene, body);
}

} // namespace pertev
