#include "scene/intensity_table.h"

#include <algorithm>
#include <span>
#include <utility>

#include "base/error.h"
#include "math/double_pi.h"
#include "math/portable_math.h"

namespace pertev {
namespace {

Rgb value_at(const Image& values, uint32_t x, uint32_t y) {
    const float* const p = values.at(x, y);
    return {p[0], p[1], p[2]};
}

/// Copies a picture's colours, without what is no intensity.
Image usable_colors(const Image& from) {
    Image to = {.width = from.width, .height = from.height, .channels = 3, .pixels = {}};
    to.pixels.resize(3 * (from.pixels.size() / from.channels));
    for (std::size_t i = 0; 3 * i < to.pixels.size(); ++i) {
        for (std::size_t channel = 0; channel < 3; ++channel) {
            const float value = from.pixels[from.channels * i + (from.channels < 3 ? 0 : channel)];
            to.pixels[3 * i + channel] = value > 0 && is_finite(value) ? value : 0.0f;
        }
    }
    return to;
}

Hash128 hash_of(const IntensityTable& table) {
    Hasher hasher;
    hasher.add_value(static_cast<uint32_t>(table.layout) * 16 + static_cast<uint32_t>(table.filter));
    for (const float value : {table.first_angle, table.last_angle, table.half_width, table.half_height})
        hasher.add_value(value);
    hasher.add_value(table.values.width);
    hasher.add_values(std::span<const float>(table.values.pixels));
    return hasher.result();
}

} // namespace

Rgb IntensityTable::mean_of_cell(uint32_t column, uint32_t row) const {
    const auto wrapped = [&](uint32_t x) { return (x + values.width) % values.width; };
    const bool goes_round = layout == TableLayout::Angles;
    switch (filter) {
    case TableFilter::Nearest:
        return value_at(values, column, row);
    case TableFilter::Knots: {
        const uint32_t next = wrapped(column + 1);
        const Rgb above = value_at(values, column, row) + value_at(values, next, row);
        const Rgb below = value_at(values, column, row + 1) + value_at(values, next, row + 1);
        return 0.25f * (above + below);
    }
    case TableFilter::Linear:
        break;
    }
    // Half of the cell on each side leans to the neighbour by a quarter on average.
    const uint32_t left = column > 0 ? column - 1 : (goes_round ? wrapped(column - 1) : 0);
    const uint32_t right = column + 1 < values.width ? column + 1 : (goes_round ? 0 : column);
    const auto mean_of_row = [&](uint32_t y) {
        return 0.125f * (value_at(values, left, y) + 6.0f * value_at(values, column, y) + value_at(values, right, y));
    };
    return 0.125f * (mean_of_row(row > 0 ? row - 1 : 0) + 6.0f * mean_of_row(row) +
                     mean_of_row(std::min(row + 1, values.height - 1)));
}

double IntensityTable::measure_of_cell(uint32_t column, uint32_t row) const {
    const double across = columns(), down = rows();
    switch (layout) {
    case TableLayout::Octahedron:
        return 4 * kPiDouble / (across * down);
    case TableLayout::Angles: {
        const float step = (last_angle - first_angle) / static_cast<float>(rows());
        const float middle = first_angle + (static_cast<float>(row) + 0.5f) * step;
        return 2 * kPiDouble / across * 2 * static_cast<double>(sin(middle)) * static_cast<double>(sin(0.5f * step));
    }
    case TableLayout::Perspective:
    case TableLayout::PictureIrradiance:
        break;
    }
    const double area = 4 * static_cast<double>(half_width) * static_cast<double>(half_height) / (across * down);
    if (layout == TableLayout::PictureIrradiance) return area;
    const double x = static_cast<double>(half_width) * (2 * (column + 0.5) / across - 1);
    const double y = static_cast<double>(half_height) * (2 * (row + 0.5) / down - 1);
    const float cosine = 1.0f / sqrt(static_cast<float>(1 + x * x + y * y));
    return area * static_cast<double>(cosine * cosine * cosine);
}

std::shared_ptr<const IntensityTable> make_intensity_table(IntensityTable table, float& greatest) {
    PERTEV_CHECK(table.values.width > 0 && table.values.height > 0);
    PERTEV_CHECK(table.filter != TableFilter::Knots ||
                 (table.layout == TableLayout::Angles && table.values.height >= 2));
    table.values = usable_colors(table.values);
    greatest = *std::ranges::max_element(table.values.pixels);
    if (greatest > 0) {
        for (float& value : table.values.pixels) value /= greatest;
    }
    double sum[3] = {};
    for (uint32_t row = 0; row < table.rows(); ++row) {
        for (uint32_t column = 0; column < table.columns(); ++column) {
            const Rgb mean = table.mean_of_cell(column, row);
            const double measure = table.measure_of_cell(column, row);
            sum[0] += measure * static_cast<double>(mean.r);
            sum[1] += measure * static_cast<double>(mean.g);
            sum[2] += measure * static_cast<double>(mean.b);
        }
    }
    table.integral = {static_cast<float>(sum[0]), static_cast<float>(sum[1]), static_cast<float>(sum[2])};
    table.hash = hash_of(table);
    return std::make_shared<const IntensityTable>(std::move(table));
}

} // namespace pertev
