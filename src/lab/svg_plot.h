#pragma once

// Bars, curves and drawings as SVG elements that stand in an HTML page by themselves: no script, no font, no style from
// outside.

#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace pertev {

/// With & < > " written so that HTML and SVG show them.
std::string html_text(std::string_view text);

/// `content` under a title: an element that is a file too.
std::string svg_drawing(double width, double height, const std::string& title, const std::string& content);

/// How a bar looks. There are kBarColors colours; more repeat them.
struct BarStyle {
    uint32_t color = 0;
    bool is_hollow = false; // a dashed outline, white inside
};
inline constexpr uint32_t kBarColors = 10;

struct Bar {
    std::string label;
    double value = 0, least = 0, largest = 0; // least and largest are drawn as a whisker
    BarStyle style = {};
};
struct BarLegend {
    std::string label;
    BarStyle style;
};

/// Horizontal bars, in the order given, and beneath them what their looks mean. Nothing where no bar has a length.
std::string svg_bars(const std::string& title, const std::string& unit, const std::vector<Bar>& bars,
                     const std::vector<BarLegend>& legend = {});

struct Curve {
    std::string label;
    std::vector<std::pair<double, double>> points;    // x rising
    std::vector<std::pair<double, double>> band = {}; // least and largest y at each point; empty: none
    bool is_level = false;                            // a dashed grey line without marks
};

struct PlotAxes {
    bool log_x = false, log_y = false; // such an axis leaves out what is not above 0
};

/// At most ten curves show well. A vertical axis that is not logarithmic starts at 0. Nothing where all points have one
/// x, or no height.
std::string svg_curves(const std::string& title, const std::string& x_label, const std::string& y_label,
                       const std::vector<Curve>& curves, const PlotAxes& axes = {});

/// Steps of 1, 2 or 5 times a power of ten: at most `count` of them from 0 to `most` > 0.
double axis_step(double most, int count);

} // namespace pertev
