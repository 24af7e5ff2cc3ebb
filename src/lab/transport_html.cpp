// html_of of write_transport.h.

#include <algorithm>

#include <fmt/format.h>

#include "lab/html_table.h"
#include "lab/svg_plot.h"
#include "lab/write_html.h"
#include "lab/write_transport.h"

namespace pertev {
namespace {

constexpr uint32_t kTransportPictureWidth = 320;

enum class Metric { RelMse, Flip };
enum class Over { Seconds, Samples };

std::string plot(const TransportScene& scene, Metric metric, Over over) {
    std::vector<Curve> curves;
    double least = 1e300, most = 0;
    for (const TransportRow& row : scene.rows) {
        if (row.is_solved && over == Over::Samples) continue;
        Curve curve = {row.name + (row.finds_all ? "" : " *"), {}};
        for (const TransportPoint& p : points_of(row)) {
            const double x = over == Over::Seconds ? p.seconds.mean : p.samples;
            const Estimate& y = metric == Metric::RelMse ? p.rel_mse : p.flip;
            const double half = y.half_width.value_or(0);
            curve.points.emplace_back(x, y.mean);
            curve.band.emplace_back(y.mean - half, y.mean + half);
            least = std::min(least, x), most = std::max(most, x);
        }
        if (!curve.points.empty()) curves.push_back(std::move(curve));
    }
    const std::optional<double> noise = metric == Metric::RelMse ? scene.reference.rel_mse : std::nullopt;
    if (noise && !curves.empty()) curves.push_back({"reference's noise", {{least, *noise}, {most, *noise}}, {}, true});
    const char* name = metric == Metric::RelMse ? "relMSE" : "HDR-FLIP";
    return svg_curves(fmt::format("{}: {} over {}", scene.name, name, over == Over::Seconds ? "time" : "samples"),
                      over == Over::Seconds ? "seconds of rendering" : "samples of each pixel", name, curves,
                      {.log_x = true, .log_y = true});
}

std::string list_item(const char* name, const std::string& text) {
    return text.empty() ? "" : fmt::format("<li>{}: {}</li>\n", name, html_text(text));
}

std::string html_list(const std::vector<std::string>& lines) {
    std::string items;
    for (const std::string& line : lines) items += "<li>" + html_text(line) + "</li>\n";
    return items.empty() ? "" : "<ul>\n" + items + "</ul>\n";
}

std::string html_of(const TransportScene& scene) {
    std::string html = fmt::format("<h2>{}</h2>\n", html_text(scene.name));
    if (scene.interrupted) html += "<p class=\"wrong\">Interrupted: this is what had been measured.</p>\n";
    html += "<ul>\n" + list_item("What it shows", scene.shows) + list_item("Camera", scene.camera) +
            list_item("Triangles", fmt::format("{}", scene.triangles)) +
            list_item("Reference", describe_reference(scene.reference)) + "</ul>\n";
    if (has_findings(scene)) {
        for (const Over over : {Over::Seconds, Over::Samples}) {
            for (const Metric metric : {Metric::RelMse, Metric::Flip}) html += plot(scene, metric, over);
        }
        html += fmt::format("<h3>After {:.3g} s of rendering each</h3>\n{}<h3>After {} samples of each pixel</h3>\n{}",
                            equal_seconds(scene), html_table(equal_time_table(scene)), equal_samples(scene),
                            html_table(equal_samples_table(scene)));
    }
    const std::vector<std::string> without = rows_without_figures(scene);
    if (!without.empty()) html += "<h3>Without figures</h3>\n" + html_list(without);
    if (!scene.notes.empty()) html += "<h3>Notes</h3>\n" + html_list(scene.notes);
    for (const Picture& picture : scene.pictures)
        html += html_image(picture.image, picture.caption, kTransportPictureWidth);
    return html;
}

} // namespace

std::string html_of(const TransportReport& report) {
    std::string body;
    if (report.interrupted) {
        body += "<p class=\"wrong\">Interrupted: what follows is what had been measured.</p>\n";
    }
    body += "<ul>\n" + list_item("Device", report.device) +
            list_item("Threads of the CPU", report.threads > 0 ? fmt::format("{}", report.threads) : "") +
            list_item("Pertev", report.commit) +
            list_item("Size", fmt::format("{} x {}", report.width, report.height)) +
            list_item("Scatterings", fmt::format("at most {}", report.max_depth)) +
            list_item("Time", fmt::format("{:g} s of rendering for each integrator, in {}", report.seconds,
                                          report.repetitions == 1
                                              ? "one repetition"
                                              : fmt::format("{} repetitions of other seeds", report.repetitions))) +
            "</ul>\n";
    body +=
        "<p>relMSE is the mean of (x - r)<sup>2</sup> / (r<sup>2</sup> + 0.01) over pixels and channels, r the "
        "reference; HDR-FLIP is how visible the difference is, from 0 to 1: both as <em>pertev compare</em> has "
        "them. Points are means over repetitions; bands are 95 % confidence intervals of these means by Student's "
        "t, point by point (the points of one curve share samples). Time is that of rendering alone. An "
        "integrator with a star does not find all light, or blurs it: its curve ends in a floor, its bias. One "
        "over relMSE times seconds is the efficiency: of noise alone it does not depend on the time. The dashed "
        "line is what the reference's own noise adds to each relMSE. Radiosity is solved, and each of its points is "
        "a solution of its own, with patches half as large as the one before: its time is that of solving and of "
        "rendering. Memory is the device's; behind a + stands what solving took of the host's, or "
        "what the records of irradiance caching may take of it at most. At equal time stands the last solution that "
        "was there by then; "
        "samples make none of them better.</p>\n";
    for (const TransportScene& scene : report.scenes) body += html_of(scene);
    return html_page("Pertev laboratory of light transport", body);
}

} // namespace pertev
