#include "lab/svg_plot.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "math/portable_math.h"

namespace pertev {
namespace {

constexpr const char* kColors[] = {"#1f77b4", "#d62728", "#2ca02c", "#9467bd", "#ff7f0e",
                                   "#17becf", "#8c564b", "#e377c2", "#7f7f7f", "#bcbd22"};
static_assert(std::size(kColors) == kBarColors);

/// Room for the longest of the labels, in the font of svg_drawing().
template <class Labelled>
double label_width(const std::vector<Labelled>& all, double least) {
    std::size_t longest = 0;
    for (const Labelled& one : all) longest = std::max(longest, one.label.size());
    return std::max(least, 16 + 6.0 * static_cast<double>(longest));
}

std::string text_at(double x, double y, const char* anchor, const std::string& text) {
    return fmt::format(R"(<text x="{:.1f}" y="{:.1f}" text-anchor="{}">{}</text>)", x, y, anchor, html_text(text));
}

std::string line(double x0, double y0, double x1, double y1, const char* color) {
    return fmt::format(R"(<line x1="{:.1f}" y1="{:.1f}" x2="{:.1f}" y2="{:.1f}" stroke="{}"/>)", x0, y0, x1, y1, color);
}

std::string rect(double x, double y, double width, double height, const BarStyle& style, const std::string& tip) {
    const char* color = kColors[style.color % kBarColors];
    const std::string outline = fmt::format(R"( stroke="{}" stroke-dasharray="3 2")", color);
    return fmt::format(
        R"(<rect x="{:.1f}" y="{:.1f}" width="{:.1f}" height="{:.1f}" fill="{}"{}><title>{}</title></rect>)", x, y,
        width, height, style.is_hollow ? "#fff" : color, style.is_hollow ? outline : "", html_text(tip));
}

double log10_of(double value) { return static_cast<double>(log2(static_cast<float>(value))) * 0.30102999566; }

/// From least to most, straight or in logarithms.
class Axis {
public:
    Axis(bool is_log, double least, double most) : is_log_(is_log), least_(least), most_(most) {}

    /// 0 at the least, 1 at the most; of logarithms 0 for what has none.
    double place(double value) const {
        if (!is_log_) return (value - least_) / (most_ - least_);
        if (!(value > 0)) return 0;
        return (log10_of(value) - log10_of(least_)) / (log10_of(most_) - log10_of(least_));
    }
    /// Every `step` from the least on; of logarithms every power of ten, and where these are few, 2 and 5 of each.
    std::vector<double> ticks(double step) const {
        std::vector<double> at;
        if (!is_log_) {
            for (int i = 0; least_ + i * step <= most_; ++i) at.push_back(least_ + i * step);
            return at;
        }
        const bool few = log10_of(most_) - log10_of(least_) < 3;
        double power = 1;
        while (power > least_) power /= 10;
        while (power * 10 < least_) power *= 10;
        for (; power <= most_; power *= 10) {
            for (const double part : {1.0, 2.0, 5.0}) {
                const double value = part * power;
                if ((few || part == 1) && value >= least_ && value <= most_) at.push_back(value);
            }
        }
        return at;
    }

private:
    bool is_log_;
    double least_, most_;
};

/// `shows` says which points are drawn, `place` where. Without its label.
template <class Shows, class Place>
std::string draw_curve(const Curve& curve, const char* color, bool is_dashed, const Shows& shows, const Place& place) {
    std::string points, highs, lows, marks;
    for (std::size_t k = 0; k < curve.points.size(); ++k) {
        if (!shows(curve.points[k])) continue;
        const auto [x, y] = place(curve.points[k]);
        points += fmt::format("{:.1f},{:.1f} ", x, y);
        marks += fmt::format(R"(<circle cx="{:.1f}" cy="{:.1f}" r="2.5" fill="{}"><title>{}: {:g}</title></circle>)", x,
                             y, color, html_text(curve.label), curve.points[k].second);
        if (k >= curve.band.size()) continue;
        const auto [least, largest] = curve.band[k];
        highs += fmt::format("{:.1f},{:.1f} ", x, place({curve.points[k].first, largest}).second);
        lows = fmt::format("{:.1f},{:.1f} ", x, place({curve.points[k].first, least}).second) + lows;
    }
    std::string drawn;
    if (!highs.empty()) {
        drawn = fmt::format(R"(<polygon points="{}{}" fill="{}" fill-opacity="0.15"/>)", highs, lows, color);
    }
    drawn += fmt::format(R"(<polyline points="{}" fill="none" stroke="{}" stroke-width="1.8"{}/>)", points, color,
                         is_dashed ? R"( stroke-dasharray="5 3")" : "");
    return curve.is_level ? drawn : drawn + marks;
}

} // namespace

std::string html_text(std::string_view text) {
    std::string out;
    for (const char c : text) {
        switch (c) {
        case '&':
            out += "&amp;";
            break;
        case '<':
            out += "&lt;";
            break;
        case '>':
            out += "&gt;";
            break;
        case '"':
            out += "&quot;";
            break;
        default:
            out += c;
        }
    }
    return out;
}

double axis_step(double most, int count) {
    double step = 1;
    while (step * count < most) step *= 10;
    while (step / 10 * count >= most) step /= 10;
    for (const double part : {0.2, 0.5}) {
        if (step * part * count >= most) return step * part;
    }
    return step;
}

std::string svg_bars(const std::string& title, const std::string& unit, const std::vector<Bar>& bars,
                     const std::vector<BarLegend>& legend) {
    constexpr double length = 490, right = 80, top = 40, row = 17;
    double most = 0;
    for (const Bar& bar : bars) most = std::max({most, bar.value, bar.largest});
    if (!(most > 0) || !std::isfinite(most)) return {};
    const double left = label_width(bars, 100), width = left + length + right, scale = length / most;
    const double bottom = top + row * static_cast<double>(bars.size());
    std::string content;
    const double step = axis_step(most, 6);
    for (int i = 0; i * step <= most; ++i) {
        const double at = i * step;
        content += line(left + at * scale, top - 4, left + at * scale, bottom, "#ddd");
        content += text_at(left + at * scale, top - 8, "middle", fmt::format("{:g}", at));
    }
    content += text_at(width - 4, top - 8, "end", unit) + '\n';
    double y = top;
    for (const Bar& bar : bars) {
        const double middle = y + row / 2;
        content +=
            rect(left, y + 2, bar.value * scale, row - 4, bar.style, fmt::format("{}: {:g}", bar.label, bar.value));
        if (bar.largest > bar.least) {
            content += line(left + bar.least * scale, middle, left + bar.largest * scale, middle, "#000");
        }
        content += text_at(left - 6, middle + 4, "end", bar.label);
        content += text_at(left + std::max(bar.value, bar.largest) * scale + 5, middle + 4, "start",
                           fmt::format("{:.4g}", bar.value)) +
                   '\n';
        y += row;
    }
    double x = 12;
    for (const BarLegend& entry : legend) {
        const double entry_width = 30 + 6.0 * static_cast<double>(entry.label.size());
        if (x > 12 && x + entry_width > width) x = 12, y += row;
        content += rect(x, y + 8, 12, 10, entry.style, entry.label) + text_at(x + 16, y + 17, "start", entry.label);
        x += entry_width;
    }
    return svg_drawing(width, y + (legend.empty() ? 10 : 26), title, content + '\n');
}

std::string svg_curves(const std::string& title, const std::string& x_label, const std::string& y_label,
                       const std::vector<Curve>& curves, const PlotAxes& axes) {
    constexpr double plot_width = 500, height = 380, left = 70, top = 40, bottom = 45;
    const auto shows = [&](const std::pair<double, double>& p) {
        return (p.first > 0 || !axes.log_x) && (p.second > 0 || !axes.log_y) && std::isfinite(p.second);
    };
    double most_x = 0, most_y = 0, least_x = 1e300, least_y = 1e300;
    for (const Curve& curve : curves) {
        for (const auto& [x, y] : curve.points) {
            if (!axes.log_y && !std::isfinite(y)) return {};
            if (!shows({x, y})) continue;
            most_x = std::max(most_x, x), least_x = std::min(least_x, x);
            most_y = std::max(most_y, y), least_y = std::min(least_y, y);
        }
    }
    if (!(most_y > 0) || !(most_x > least_x)) return {};
    const double right = 40 + label_width(curves, 100), width = left + plot_width + right;
    constexpr double plot_height = height - top - bottom;
    const Axis along(axes.log_x, least_x, most_x);
    const Axis up = axes.log_y ? Axis(true, least_y / 1.2, most_y * 1.2) : Axis(false, 0, most_y);
    const auto at_x = [&](double x) { return left + along.place(x) * plot_width; };
    const auto at_y = [&](double y) { return top + (1 - std::clamp(up.place(y), 0.0, 1.0)) * plot_height; };
    std::string content;
    for (const double y : up.ticks(axis_step(most_y, 6))) {
        content += line(left, at_y(y), left + plot_width, at_y(y), "#ddd");
        content += text_at(left - 6, at_y(y) + 4, "end", fmt::format("{:g}", y));
    }
    for (const double x : along.ticks(std::max(1.0, axis_step(most_x - least_x, 10)))) {
        content += line(at_x(x), top + plot_height, at_x(x), top + plot_height + 4, "#000");
        content += text_at(at_x(x), top + plot_height + 16, "middle", fmt::format("{:g}", x));
    }
    content += line(left, top + plot_height, left + plot_width, top + plot_height, "#000");
    content += text_at(left + plot_width / 2, height - 10, "middle", x_label) + text_at(8, top - 8, "start", y_label);
    const auto place = [&](const std::pair<double, double>& p) { return std::pair(at_x(p.first), at_y(p.second)); };
    for (std::size_t i = 0; i < curves.size(); ++i) {
        const char* color = curves[i].is_level ? "#888" : kColors[i % std::size(kColors)];
        content += draw_curve(curves[i], color, curves[i].is_level || i >= std::size(kColors), shows, place);
        const double y = top + 14 * static_cast<double>(i);
        content += fmt::format(R"(<rect x="{:.0f}" y="{:.0f}" width="10" height="10" fill="{}"/>)", width - right + 20,
                               y, color);
        content += text_at(width - right + 36, y + 9, "start", curves[i].label) + '\n';
    }
    return svg_drawing(width, std::max(height, top + 14 * static_cast<double>(curves.size()) + 10), title, content);
}

std::string svg_drawing(double width, double height, const std::string& title, const std::string& content) {
    return fmt::format(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {0:.0f} {1:.0f}\" width=\"{0:.0f}\" "
        "height=\"{1:.0f}\" font-family=\"sans-serif\" font-size=\"11\" role=\"img\">\n"
        "<title>{2}</title><text x=\"8\" y=\"16\" font-size=\"13\" font-weight=\"bold\">{2}</text>\n{3}</svg>\n",
        width, height, html_text(title), content);
}

} // namespace pertev
