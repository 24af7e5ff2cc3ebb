#include "formats/ies/read_ies.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "base/error.h"
#include "base/message_text.h"
#include "base/read_file.h"
#include "formats/files/parse_number.h"
#include "math/double_pi.h"
#include "math/portable_math.h"

namespace pertev {
namespace {

constexpr uint32_t kMostSteps = 1440, kMostValues = 1u << 24;
constexpr double kMostCandelas = 0x1p40; // the most that `lamp` accepts

/// The numbers of a file, one after the other.
class Numbers {
public:
    Numbers(std::string_view text, std::string name) : rest_(text), name_(std::move(name)) {}

    FileLocation location() const { return {name_, line_}; }
    [[noreturn]] void fail(const std::string& why) const { throw Error(ErrorCode::BadInput, location(), why); }
    bool is_at_end() const { return rest_.empty(); }
    /// Removes a line, without its end.
    std::string_view take_line() {
        const std::size_t end = std::min(rest_.find('\n'), rest_.size());
        std::string_view line = rest_.substr(0, end);
        rest_.remove_prefix(std::min(end + 1, rest_.size()));
        ++line_;
        while (!line.empty() && static_cast<unsigned char>(line.back()) <= ' ') line.remove_suffix(1);
        return line;
    }
    double next(const char* what) {
        skip_space();
        if (rest_.empty()) fail(fmt::format("the file ends before {}", what));
        const std::string_view before = rest_;
        const std::optional<double> value = parse_float<double>(rest_);
        if (!value || !std::isfinite(*value)) {
            const std::string_view word = before.substr(0, before.find_first_of(" ,\t\r\n"));
            fail(fmt::format("{} is not a number; expected {}", shortened(std::string(word)), what));
        }
        return *value;
    }
    /// Returns a count in [least, most].
    uint32_t next_count(const char* what, uint32_t least, uint32_t most) {
        const double value = next(what);
        if (!(value >= least && value <= most) || value != std::floor(value))
            fail(fmt::format("{}; expected {} from {} to {}", value, what, least, most));
        return static_cast<uint32_t>(value);
    }
    /// Returns whether anything but space is left.
    bool has_more() {
        skip_space();
        return !rest_.empty();
    }

private:
    void skip_space() {
        while (!rest_.empty() && (static_cast<unsigned char>(rest_.front()) <= ' ' || rest_.front() == ',')) {
            if (rest_.front() == '\n') ++line_;
            rest_.remove_prefix(1);
        }
    }

    std::string_view rest_;
    std::string name_;
    std::size_t line_ = 1;
};

enum class PhotometryType { C = 1, B = 2, A = 3 };

/// Angles in degrees, ascending, and candelas at each pair.
struct Photometry {
    PhotometryType type = PhotometryType::C;
    std::vector<double> vertical, horizontal;
    std::vector<double> candelas; // [horizontal * vertical]
};

/// Skips the keywords and TILT. Returns whether the file is of an edition before 1995.
bool skip_header(Numbers& numbers, Sink& sink) {
    bool is_old = true;
    for (;;) {
        if (numbers.is_at_end()) numbers.fail("no line begins with TILT=; expected an IES photometric file");
        const FileLocation location = numbers.location();
        const std::string_view line = numbers.take_line();
        if (line.starts_with("IESNA:LM-63-") || line.starts_with("IES:LM-63-")) is_old = false;
        if (!line.starts_with("TILT=")) continue;
        const std::string_view tilt = line.substr(5);
        if (tilt == "NONE") return is_old;
        sink.warn({location, "TILT is left out; the luminaire hangs as it was measured"});
        if (tilt != "INCLUDE") return is_old;
        numbers.next("the position of the lamp");
        const uint32_t pairs = numbers.next_count("the number of tilt angles", 0, 10000);
        for (uint32_t i = 0; i < 2 * pairs; ++i) numbers.next("tilt angles and factors");
        return is_old;
    }
}

std::vector<double> take_angles(Numbers& numbers, uint32_t count, const char* what) {
    std::vector<double> angles;
    for (uint32_t i = 0; i < count; ++i) {
        const double angle = numbers.next(what);
        if (!angles.empty() && !(angle > angles.back()))
            numbers.fail(fmt::format("{} after {}; expected ascending {}", angle, angles.back(), what));
        angles.push_back(angle);
    }
    return angles;
}

void check_angles(const Photometry& photometry, const Numbers& numbers) {
    const std::vector<double>&v = photometry.vertical, &h = photometry.horizontal;
    if (photometry.type != PhotometryType::C) {
        for (const std::vector<double>* const angles : {&v, &h}) {
            if (angles->front() >= -90 && angles->back() <= 90 && angles->back() > angles->front()) continue;
            numbers.fail(fmt::format("angles are from {} to {}; expected ascending ones from -90 to 90 degrees",
                                     angles->front(), angles->back()));
        }
        return;
    }
    if (!(v.front() >= 0 && v.back() <= 180 && v.back() > v.front())) {
        numbers.fail(fmt::format("vertical angles are from {} to {}; expected angles from 0 to 180 degrees", v.front(),
                                 v.back()));
    }
    const bool is_whole = h.front() == 0 && (h.back() == 0 || h.back() == 90 || h.back() == 180 || h.back() == 360);
    if (!is_whole && !(h.front() == 90 && h.back() == 270)) {
        numbers.fail(fmt::format(
            "horizontal angles are from {} to {}; expected from 0 to 0, 90, 180 or 360, or from 90 to 270 degrees",
            h.front(), h.back()));
    }
}

Photometry take_photometry(Numbers& numbers, bool is_old, std::size_t bytes, Sink& sink) {
    numbers.next("the number of lamps");
    numbers.next("the lumens of a lamp");
    double factor = numbers.next("the multiplier of candelas");
    const uint32_t vertical = numbers.next_count("the number of vertical angles", 2, kMostValues);
    const uint32_t horizontal = numbers.next_count("the number of horizontal angles", 1, kMostValues);
    Photometry photometry;
    photometry.type = static_cast<PhotometryType>(numbers.next_count("the type of photometry", 1, 3));
    for (const char* const what : {"the type of units", "a width", "a length", "a height"}) numbers.next(what);
    factor *= numbers.next("the ballast factor");
    const double of_lamp = numbers.next("the ballast-lamp factor");
    if (is_old) factor *= of_lamp; // since 1995 the number says other things
    numbers.next("the watts");
    const uint64_t count = uint64_t(vertical) * horizontal;
    if (count > bytes || count > kMostValues) {
        numbers.fail(fmt::format("{} x {} candelas; the file cannot hold them", vertical, horizontal));
    }
    photometry.vertical = take_angles(numbers, vertical, "vertical angles");
    photometry.horizontal = take_angles(numbers, horizontal, "horizontal angles");
    check_angles(photometry, numbers);
    bool any_negative = false;
    for (uint64_t i = 0; i < count; ++i) {
        const double candela = numbers.next("candelas") * factor;
        if (!(candela <= kMostCandelas)) numbers.fail(fmt::format("{} candelas; expected at most 2^40", candela));
        any_negative |= candela < 0;
        photometry.candelas.push_back(std::max(candela, 0.0));
    }
    if (any_negative) sink.warn({numbers.location(), "negative candelas are 0"});
    if (numbers.has_more()) sink.warn({numbers.location(), "the file goes on after the last candela"});
    return photometry;
}

/// Returns the least number of equal steps that meet all angles; `most` if no fewer do.
uint32_t steps_of(const std::vector<double>& angles, uint32_t most) {
    const double range = angles.back() - angles.front();
    if (!(range > 0)) return 1;
    for (auto steps = static_cast<uint32_t>(angles.size() - 1); steps < most; ++steps) {
        const auto is_met = [&](double angle) {
            const double at = (angle - angles.front()) / range * steps;
            return std::abs(at - std::round(at)) < 1e-5 * steps;
        };
        if (std::ranges::all_of(angles, is_met)) return steps;
    }
    return most;
}

/// A position between two angles of a list.
struct Between {
    std::size_t below;
    double t;
};
Between find_between(const std::vector<double>& angles, double angle) {
    const auto above = std::ranges::upper_bound(angles, angle);
    const auto last = static_cast<std::ptrdiff_t>(angles.size()) - 2;
    if (last < 0) return {0, 0};
    const auto below = static_cast<std::size_t>(std::clamp<std::ptrdiff_t>(above - angles.begin() - 1, 0, last));
    return {below, std::clamp((angle - angles[below]) / (angles[below + 1] - angles[below]), 0.0, 1.0)};
}

double candela_at(const Photometry& photometry, double vertical, double horizontal) {
    const Between v = find_between(photometry.vertical, vertical), h = find_between(photometry.horizontal, horizontal);
    const auto of_plane = [&](std::size_t plane) {
        const double* const of = photometry.candelas.data() + plane * photometry.vertical.size() + v.below;
        return v.t > 0 ? of[0] + v.t * (of[1] - of[0]) : of[0];
    };
    const double first = of_plane(h.below);
    return h.t > 0 ? first + h.t * (of_plane(h.below + 1) - first) : first;
}

/// Returns the angle of the file's range that has the same intensity as one of the whole circle.
double folded(const std::vector<double>& horizontal, double angle) {
    const double last = horizontal.back();
    if (last == 0) return 0;
    if (horizontal.front() == 90) return angle < 90 ? 180 - angle : angle > 270 ? 540 - angle : angle;
    if (last == 90 && angle > 90 && angle <= 270) return std::abs(180 - angle);
    return last < 360 && angle > 180 ? 360 - angle : angle;
}

/// Returns the candelas of types A and B in a unit direction of the table's frame.
double candela_along(const Photometry& photometry, double x, double y, double z) {
    const std::vector<double>&v = photometry.vertical, &h = photometry.horizontal;
    constexpr double degrees = 180 / kPiDouble;
    const auto angle = [&](double across, double along) {
        return static_cast<double>(atan2(static_cast<float>(across), static_cast<float>(along))) * degrees;
    };
    // The poles of A are above and below the light, those of B at its sides.
    const bool is_a = photometry.type == PhotometryType::A;
    const double vertical = is_a ? angle(y, std::sqrt(x * x + z * z)) : angle(y, z);
    double horizontal = is_a ? angle(x, z) : angle(x, std::sqrt(y * y + z * z));
    if (h.front() == 0) horizontal = std::abs(horizontal);
    constexpr double rounding = 1e-4;
    const auto is_in = [&](const std::vector<double>& angles, double at) {
        return at >= angles.front() - rounding && at <= angles.back() + rounding;
    };
    return is_in(v, vertical) && is_in(h, horizontal) ? candela_at(photometry, vertical, horizontal) : 0.0;
}

/// Returns the table of photometry of types A and B, in steps of half a degree around the light and of 720 rows.
IntensityTable table_of_front(const Photometry& photometry) {
    constexpr uint32_t kColumns = 720, kRows = 721;
    double least_cosine = 1; // in both types the cosine of the angle from +z is that of both angles
    for (const std::vector<double>* const angles : {&photometry.vertical, &photometry.horizontal}) {
        const double furthest = std::max(std::abs(angles->front()), std::abs(angles->back()));
        least_cosine *= static_cast<double>(cos(static_cast<float>(furthest * (kPiDouble / 180))));
    }
    IntensityTable table;
    table.filter = TableFilter::Knots;
    table.last_angle = min(acos(clamp(static_cast<float>(least_cosine), 0.0f, 1.0f)), 0.5f * kPi);
    table.values = {.width = kColumns, .height = kRows, .channels = 1, .pixels = {}};
    table.values.pixels.reserve(std::size_t(kColumns) * kRows);
    for (uint32_t row = 0; row < kRows; ++row) {
        const float angle = table.last_angle * (static_cast<float>(row) / (kRows - 1));
        const auto height = static_cast<double>(cos(angle)), radius = static_cast<double>(sin(angle));
        for (uint32_t column = 0; column < kColumns; ++column) {
            float sine, cosine;
            sin_cos_2pi(static_cast<float>(column) / kColumns, sine, cosine);
            table.values.pixels.push_back(static_cast<float>(candela_along(
                photometry, radius * static_cast<double>(cosine), radius * static_cast<double>(sine), height)));
        }
    }
    return table;
}

/// Returns the table of photometry of type C.
IntensityTable table_of_planes(const Photometry& photometry) {
    const std::vector<double>&v = photometry.vertical, &h = photometry.horizontal;
    const double range = h.back() - h.front();
    uint32_t of_range = steps_of(h, static_cast<uint32_t>(kMostSteps * range / 360));
    if (h.front() == 90 && of_range % 2 != 0) of_range *= 2; // because columns begin at 0
    const uint32_t columns = range > 0 ? static_cast<uint32_t>(std::lround(of_range * 360 / range)) : 1;
    const uint32_t rows = steps_of(v, kMostSteps) + 1;
    IntensityTable table;
    table.filter = TableFilter::Knots;
    table.first_angle = static_cast<float>(v.front() / 180) * kPi;
    table.last_angle = static_cast<float>(v.back() / 180) * kPi;
    table.values = {.width = columns, .height = rows, .channels = 1, .pixels = {}};
    table.values.pixels.reserve(std::size_t(rows) * columns);
    for (uint32_t row = 0; row < rows; ++row) {
        const double vertical = v.front() + (v.back() - v.front()) * row / (rows - 1);
        for (uint32_t column = 0; column < columns; ++column)
            table.values.pixels.push_back(
                static_cast<float>(candela_at(photometry, vertical, folded(h, 360.0 * column / columns))));
    }
    return table;
}

} // namespace

IntensityTable parse_ies(std::string_view text, const std::string& name, Sink& sink) {
    Numbers numbers(text, name);
    const bool is_old = skip_header(numbers, sink);
    const Photometry photometry = take_photometry(numbers, is_old, text.size(), sink);
    IntensityTable table =
        photometry.type == PhotometryType::C ? table_of_planes(photometry) : table_of_front(photometry);
    if (!std::ranges::any_of(table.values.pixels, [](float candela) { return candela > 0; }))
        throw Error(ErrorCode::BadInput, FileLocation{name}, "all candelas are 0");
    return table;
}

IntensityTable read_ies(const std::filesystem::path& path, Sink& sink) {
    const std::vector<std::byte> bytes = read_file(path);
    return parse_ies({reinterpret_cast<const char*>(bytes.data()), bytes.size()}, path.string(), sink);
}

} // namespace pertev
