#pragma once

// Bars and curves as SVG elements that stand in an HTML page by themselves: no script, no font, no style from outside.

#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace pertev {

/// With & < > " written so that HTML and SVG show them.
std::string html_text(std::string_view text);

struct Bar {
    std::string label;
    double value = 0, least = 0, largest = 0; // least and largest are drawn as a whisker
};

/// Horizontal bars, in the order given.
std::string svg_bars(const std::string& title, const std::string& unit, const std::vector<Bar>& bars);

struct Curve {
    std::string label;
    std::vector<std::pair<double, double>> points; // x rising
};

/// At most ten curves show well. The vertical axis starts at 0.
std::string svg_curves(const std::string& title, const std::string& x_label, const std::string& y_label,
                       const std::vector<Curve>& curves);

/// Steps of 1, 2 or 5 times a power of ten: at most `count` of them from 0 to `most` > 0.
double axis_step(double most, int count);

} // namespace pertev
