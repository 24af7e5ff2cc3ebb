#include "shading/goniometric_light.h"

#include <span>

#include "math/frame.h"

namespace pertev {
namespace {

double total(Rgb c) { return static_cast<double>(c.r) + static_cast<double>(c.g) + static_cast<double>(c.b); }

/// Appends a cdf of the weights and returns their sum.
double append_cdf(std::span<const double> weights, GoniometricTables& to) {
    const std::size_t start = to.starts.size(), guide = to.guides.size();
    to.starts.resize(start + weights.size() + 1);
    to.guides.resize(guide + (std::size_t(1) << guide_bits_for(weights.size())) + 1);
    return build_guided_cdf(weights, std::span(to.starts).subspan(start), std::span(to.guides).subspan(guide));
}

/// Appends the values and the cdfs of the cells.
void append_arrays(const IntensityTable& from, GoniometricTable& table, GoniometricTables& to) {
    table.first_value = static_cast<uint32_t>(to.values.size());
    table.first_start = static_cast<uint32_t>(to.starts.size());
    table.first_guide = static_cast<uint32_t>(to.guides.size());
    const std::vector<float>& numbers = from.values.pixels;
    for (std::size_t i = 0; i < numbers.size(); i += 3)
        to.values.push_back({numbers[i], numbers[i + 1], numbers[i + 2]});
    std::vector<double> of_rows(from.rows());
    std::vector<std::vector<double>> weights(from.rows());
    for (uint32_t row = 0; row < from.rows(); ++row) {
        double measure = 0;
        for (uint32_t column = 0; column < from.columns(); ++column) {
            // All cells of a row of angles have one measure.
            if (column == 0 || from.layout != TableLayout::Angles) measure = from.measure_of_cell(column, row);
            weights[row].push_back(total(from.mean_of_cell(column, row)) * measure);
        }
        for (const double weight : weights[row]) of_rows[row] += weight;
    }
    append_cdf(of_rows, to);
    for (const std::vector<double>& of_row : weights) append_cdf(of_row, to);
}

/// Returns the smallest cosine to the axis of a corner of the cells that are not black.
float cosine_of_cone(const IntensityTable& from, const GoniometricTable& table) {
    float least = 1;
    for (uint32_t row = 0; row < from.rows(); ++row) {
        for (uint32_t column = 0; column < from.columns(); ++column) {
            if (!(total(from.mean_of_cell(column, row)) > 0)) continue;
            for (int corner = 0; corner < 4; ++corner) {
                const Vec2 at = {static_cast<float>(corner & 1), static_cast<float>(corner >> 1)};
                least = min(least, direction_in_cell(table, column, row, at).z);
            }
            if (from.layout == TableLayout::Angles) break; // all cells of a row have one height
        }
    }
    return clamp(least - 0x1p-20f, -1.0f, 1.0f - 0x1p-20f);
}

} // namespace

float GoniometricTables::add(const Light& light, uint32_t sharing) {
    const IntensityTable& from = *light.table;
    GoniometricTable table = sharing < tables.size() ? tables[sharing] : GoniometricTable{};
    table.layout = from.layout, table.filter = from.filter;
    table.width = from.values.width, table.height = from.values.height, table.rows = from.rows();
    table.first_angle = from.first_angle, table.last_angle = from.last_angle;
    table.half_width = from.half_width, table.half_height = from.half_height;
    table.row_bits = guide_bits_for(table.rows), table.column_bits = guide_bits_for(table.width);
    table.forward = light.direction;
    table.up = normalize(light.up - dot(light.up, light.direction) * light.direction);
    table.right = (light.is_mirrored ? -1.0f : 1.0f) * cross(table.forward, table.up);
    if (sharing >= tables.size()) append_arrays(from, table, *this);
    cones.push_back(sharing < cones.size() ? cones[sharing] : cosine_of_cone(from, table));
    tables.push_back(table);
    return cones.back();
}

} // namespace pertev
