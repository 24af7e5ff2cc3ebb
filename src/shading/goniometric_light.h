#pragma once

// Intensities by direction on the device (scene/intensity_table.h): the value and the sampling of a light's table. Cdfs
// with guide tables select a cell of the square, its row by y and its column by x, with the probability of its mean
// times its solid angle; the rest of the numbers is uniform in that solid angle (of a picture: in its area).

#include <cstddef>
#include <cstdint>
#include <vector>

#include "base/host_device.h"
#include "math/octahedron.h"
#include "math/portable_math.h"
#include "math/rgb.h"
#include "math/scalar.h"
#include "math/vec2.h"
#include "math/vec3.h"
#include "scene/intensity_table.h"
#include "scene/light.h"
#include "shading/guided_cdf.h"

namespace pertev {

/// The table of one light. Lights that share an IntensityTable share its arrays.
struct GoniometricTable {
    TableLayout layout = TableLayout::Angles;
    TableFilter filter = TableFilter::Linear;
    uint32_t width = 1, height = 1, rows = 1; // values, and rows of cells
    Vec3 right, up, forward;                  // the frame: unit, orthogonal
    float first_angle = 0, last_angle = kPi;
    float half_width = 1, half_height = 1;
    uint32_t first_value = 0, first_start = 0, first_guide = 0; // in the arrays below: the table of rows comes first
    uint32_t row_bits = 0, column_bits = 0;                     // guide bits
};

struct GoniometricTablesView {
    const GoniometricTable* tables = nullptr;
    const Rgb* values = nullptr;
    const uint32_t *starts = nullptr, *guides = nullptr;

    HD GuidedCdfView rows_of(const GoniometricTable& table) const {
        return {starts + table.first_start, guides + table.first_guide, table.rows, table.row_bits};
    }
    HD GuidedCdfView columns_of(const GoniometricTable& table, uint32_t row) const {
        const size_t guides_of_rows = (size_t(1) << table.row_bits) + 1;
        return {starts + table.first_start + (table.rows + 1) + size_t(row) * (table.width + 1),
                guides + table.first_guide + guides_of_rows + size_t(row) * ((size_t(1) << table.column_bits) + 1),
                table.width, table.column_bits};
    }
};

HD inline bool is_picture(TableLayout layout) {
    switch (layout) {
    case TableLayout::Perspective:
    case TableLayout::PictureIrradiance:
        return true;
    case TableLayout::Angles:
    case TableLayout::Octahedron:
        break;
    }
    return false;
}

/// Finds the point of a unit direction of the table's frame in the square. Returns false beyond its edges.
HD inline bool find_table_uv(const GoniometricTable& table, Vec3 local, Vec2& uv) {
    if (is_picture(table.layout)) {
        if (!(local.z > 0)) return false;
        const float inv = 0.5f / local.z;
        uv = {0.5f + inv * local.x / table.half_width, 0.5f - inv * local.y / table.half_height};
        return uv.x >= 0 && uv.x <= 1 && uv.y >= 0 && uv.y <= 1;
    }
    if (table.layout == TableLayout::Octahedron) {
        uv = octahedral_uv(local);
        return true;
    }
    const float angle = atan2(sqrt(square(local.x) + square(local.y)), local.z);
    const float share = (angle - table.first_angle) / (table.last_angle - table.first_angle);
    const float turns = table.width > 1 ? atan2(local.y, local.x) * (0.5f * kInvPi) : 0.0f;
    const float around = turns < 0 ? turns + 1.0f : turns; // it may round to 1, which is 0
    uv = {around < 1 ? around : 0.0f, clamp(share, 0.0f, 1.0f)};
    return abs(share - uv.y) <= 0x1p-22f; // rounding is no edge
}

/// The cell of the square that holds a point, among `count` along this axis.
HD inline uint32_t table_cell(float coordinate, uint32_t count) {
    return static_cast<uint32_t>(to_int(coordinate * static_cast<float>(count), 0, static_cast<int>(count) - 1));
}

/// Value at a point of the square, [0, 1].
HD inline Rgb table_value_at(const GoniometricTablesView& view, const GoniometricTable& table, Vec2 uv) {
    const Rgb* values = view.values + table.first_value;
    if (table.filter == TableFilter::Nearest) {
        return values[size_t(table_cell(uv.y, table.height)) * table.width + table_cell(uv.x, table.width)];
    }
    const bool has_knots = table.filter == TableFilter::Knots;
    const float x = uv.x * static_cast<float>(table.width) - (has_knots ? 0.0f : 0.5f);
    const float y =
        has_knots ? uv.y * static_cast<float>(table.height - 1) : uv.y * static_cast<float>(table.height) - 0.5f;
    const int last_x = static_cast<int>(table.width) - 1, last_y = static_cast<int>(table.height) - 1;
    const int left = to_int(floor(x), -1, last_x), above = to_int(floor(y), -1, last_y);
    const bool goes_round = table.layout == TableLayout::Angles;
    const auto column = [&](int i) {
        return i < 0 ? (goes_round ? last_x : 0) : i > last_x ? (goes_round ? 0 : last_x) : i;
    };
    const auto row = [&](int i) { return values + size_t(i < 0 ? 0 : min(i, last_y)) * table.width; };
    const int at = column(left), next = column(left + 1);
    const float t = x - floor(x);
    const Rgb* upper = row(above);
    const Rgb* lower = row(above + 1);
    return lerp(lerp(upper[at], upper[next], t), lerp(lower[at], lower[next], t), y - floor(y));
}

/// Fraction of the light's intensity in the unit direction `local` of the frame.
HD inline Rgb table_value(const GoniometricTablesView& view, const GoniometricTable& table, Vec3 local) {
    Vec2 uv;
    if (!find_table_uv(table, local, uv)) return {0, 0, 0};
    const Rgb value = table_value_at(view, table, uv);
    if (table.layout != TableLayout::PictureIrradiance) return value;
    return (1.0f / (local.z * local.z * local.z)) * value;
}

/// Bounds of sin^2(theta / 2) of a row of cells of Angles, theta from the nearer pole.
struct AngleRow {
    bool is_back; // theta is the angle from -z
    float lower, upper;
};
HD inline AngleRow angle_row(const GoniometricTable& table, uint32_t row) {
    const float step = (table.last_angle - table.first_angle) / static_cast<float>(table.rows);
    const float near = table.first_angle + static_cast<float>(row) * step, far = near + step;
    const bool is_back = near + far > kPi;
    const auto of = [&](float angle) { return square(sin(0.5f * (is_back ? kPi - angle : angle))); };
    return {is_back, of(near), of(far)};
}

/// Density in a cell that has the probability `pmf`, at the unit direction `local` of the frame, 1/sr.
HD inline float pdf_in_cell(const GoniometricTable& table, uint32_t row, float pmf, Vec3 local) {
    const float columns = static_cast<float>(table.width), rows = static_cast<float>(table.rows);
    switch (table.layout) {
    case TableLayout::Angles: {
        const AngleRow bounds = angle_row(table, row);
        return pmf * columns * (0.25f * kInvPi) / abs(bounds.upper - bounds.lower);
    }
    case TableLayout::Octahedron:
        return pmf * columns * rows * (0.25f * kInvPi);
    case TableLayout::Perspective:
    case TableLayout::PictureIrradiance:
        break;
    }
    const float area = 4.0f * table.half_width * table.half_height;
    return pmf * columns * rows / (area * (local.z * local.z * local.z));
}

/// Direction of the frame at `at`, [0, 1] both ways, in a cell, uniformly distributed with it.
HD inline Vec3 direction_in_cell(const GoniometricTable& table, uint32_t column, uint32_t row, Vec2 at) {
    const Vec2 uv = {(static_cast<float>(column) + at.x) / static_cast<float>(table.width),
                     (static_cast<float>(row) + at.y) / static_cast<float>(table.rows)};
    switch (table.layout) {
    case TableLayout::Angles: {
        const AngleRow bounds = angle_row(table, row);
        const float s = lerp(bounds.lower, bounds.upper, at.y), sine = 2.0f * safe_sqrt(s * (1.0f - s));
        float x, y;
        sin_cos_2pi(uv.x, y, x);
        return {sine * x, sine * y, bounds.is_back ? 2.0f * s - 1.0f : 1.0f - 2.0f * s};
    }
    case TableLayout::Octahedron:
        return octahedral_direction(uv);
    case TableLayout::Perspective:
    case TableLayout::PictureIrradiance:
        break;
    }
    return normalize(Vec3{(2.0f * uv.x - 1.0f) * table.half_width, (1.0f - 2.0f * uv.y) * table.half_height, 1});
}

HD inline Vec3 to_table_frame(const GoniometricTable& table, Vec3 direction) {
    return {dot(table.right, direction), dot(table.up, direction), dot(table.forward, direction)};
}

/// Fraction of the intensity of light `number` of the tables in the unit `direction`, in which light travels.
HD_CALL inline Rgb goniometric_value(const GoniometricTablesView& view, uint32_t number, Vec3 direction) {
    const GoniometricTable& table = view.tables[number];
    return table_value(view, table, to_table_frame(table, direction));
}

/// Density of sample_goniometric at `direction`, 1/sr; 0 where the light is black.
HD_CALL inline float pdf_goniometric(const GoniometricTablesView& view, uint32_t number, Vec3 direction) {
    const GoniometricTable& table = view.tables[number];
    const Vec3 local = to_table_frame(table, direction);
    Vec2 uv;
    if (!find_table_uv(table, local, uv)) return 0;
    const uint32_t row = table_cell(uv.y, table.rows), column = table_cell(uv.x, table.width);
    const float of_row = cdf_pmf(view.rows_of(table), row);
    if (!(of_row > 0)) return 0;
    return pdf_in_cell(table, row, of_row * cdf_pmf(view.columns_of(table, row), column), local);
}

/// The 32 bits that select from a cdf by a number in [0, 1), whose bits end before theirs.
HD inline uint32_t bits_of_number(float u, uint32_t behind) {
    return static_cast<uint32_t>(to_int(u * 0x1p24f, 0, 0xffffff)) << 8 | (behind & 255u);
}

/// Samples a direction of light `number` of the tables, which is not black, by `u`, and sets its density, 1/sr.
HD_CALL inline Vec3 sample_goniometric(const GoniometricTablesView& view, uint32_t number, Vec2 u, float& pdf) {
    const GoniometricTable& table = view.tables[number];
    const uint32_t more = hash_word(bits_of(u.x) + hash_word(bits_of(u.y)));
    const CdfDraw row = draw_ordered(view.rows_of(table), bits_of_number(u.y, more), more);
    const CdfDraw column = draw_ordered(view.columns_of(table, row.index), bits_of_number(u.x, more >> 8), more);
    const Vec3 local = direction_in_cell(table, column.index, row.index, {rest_of(column), rest_of(row)});
    pdf = pdf_in_cell(table, row.index, cdf_pmf(row.owned) * cdf_pmf(column.owned), local);
    return normalize(local.x * table.right + local.y * table.up + local.z * table.forward);
}

/// The tables of a scene's lights, and their arrays.
struct GoniometricTables {
    std::vector<GoniometricTable> tables;
    std::vector<Rgb> values;
    std::vector<uint32_t> starts, guides;
    std::vector<float> cones; // cosine of the narrowest cone of each

    /// Adds the table of `light` and returns the cosine of the narrowest cone around its direction that holds its
    /// light, below 1. `sharing` is the number of a light with the same IntensityTable, or that of the next.
    float add(const Light& light, uint32_t sharing);
};

} // namespace pertev
