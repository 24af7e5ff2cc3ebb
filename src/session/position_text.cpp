#include "session/position_text.h"

#include <algorithm>
#include <array>
#include <charconv>

#include <fmt/format.h>

#include "scene/scene_origin.h"

namespace pertev {
namespace {

/// Removes trailing zeros: "1.5" for "1.50", and "0" for "-0.00".
std::string without_idle_zeros(std::string number) {
    if (number.find('.') != std::string::npos) {
        number.erase(number.find_last_not_of('0') + 1);
        if (number.back() == '.') number.pop_back();
    }
    return number == "-0" ? "0" : number;
}

/// Returns the number of digits of `size` before the decimal point, below 1 for leading zeros after it: 3 for 250, 0
/// for 0.5, -1 for 0.05, and 1 for 0.
int digits_above_point(double size) {
    int digits = 1;
    for (double power = 10; size >= power; power *= 10) ++digits;
    for (double least = 1; size > 0 && size < least; least /= 10) --digits;
    return digits;
}

std::array<std::string, 3> numbers_of(const Scene& scene, Vec3 p, int digits) {
    if (scene.origin_in_file == DoubleVec3{0, 0, 0}) {
        const auto text = [&](float x) { return fmt::format("{:.{}g}", x, digits); };
        return {text(p.x), text(p.y), text(p.z)};
    }
    const Bounds3 bounds = bounds_of(scene);
    const float size = bounds.is_empty() ? 1.0f : max_component(bounds.size());
    const int decimals = std::clamp(digits - digits_above_point(static_cast<double>(size)), 0, 15);
    const DoubleVec3 position = in_file(scene, p);
    const auto text = [&](double x) { return without_idle_zeros(fmt::format("{:.{}f}", x, decimals)); };
    return {text(position.x), text(position.y), text(position.z)};
}

double number(const std::string& text) {
    double value = 0;
    std::from_chars(text.data(), text.data() + text.size(), value);
    return value;
}

} // namespace

std::string position_text(const Scene& scene, Vec3 p, int digits) {
    const std::array<std::string, 3> numbers = numbers_of(scene, p, digits);
    return fmt::format("{},{},{}", numbers[0], numbers[1], numbers[2]);
}

DoubleVec3 stated_position(const Scene& scene, Vec3 p, int digits) {
    const std::array<std::string, 3> numbers = numbers_of(scene, p, digits);
    return {number(numbers[0]), number(numbers[1]), number(numbers[2])};
}

DoubleVec3 stated_position(Vec3 p, DoubleVec3 origin) {
    if (origin != DoubleVec3{0, 0, 0}) return origin + to_double(p);
    const auto shortest = [](float x) { return number(fmt::format("{}", x)); };
    return {shortest(p.x), shortest(p.y), shortest(p.z)};
}

} // namespace pertev
