#pragma once

// Steps of Mitsuba's transforms. A later step of a <transform> is applied after the earlier ones.

#include <optional>
#include <string_view>
#include <vector>

#include "math/double_transform.h"

namespace pertev::mitsuba {

struct TransformStep {
    std::vector<double> vector; // numbers of translate, scale and rotate
    double angle_deg = 0;
    std::vector<double> matrix; // 16 numbers, row by row, or 9 without a translation
    bool is_flat = false;       // 9 numbers are those of a map in two dimensions, as of texture coordinates
    std::vector<double> origin, target, up;
};

/// Returns the map of a step by its name in XML; nothing if it has no inverse or too few numbers. That of lookat maps
/// a camera that looks along +z, with +x to the left and +y up.
std::optional<DoubleTransform> make_transform(std::string_view kind, const TransformStep& step);

/// Returns the 12 numbers of a transform, row by row, and the transform of such numbers.
std::vector<double> numbers_of(const DoubleTransform& transform);
DoubleTransform transform_of_rows(const std::vector<double>& numbers);

} // namespace pertev::mitsuba
