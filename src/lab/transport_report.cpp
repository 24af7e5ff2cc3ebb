#include "lab/transport_report.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "math/portable_math.h"

namespace pertev {
namespace {

/// Returns the position of `x` between `a` and `b` on a logarithmic scale: 0 at `a`, 1 at `b`.
double log_share(double x, double a, double b) {
    const float ends = log(static_cast<float>(b)) - log(static_cast<float>(a));
    if (!(ends > 0)) return 1;
    return static_cast<double>((log(static_cast<float>(x)) - log(static_cast<float>(a))) / ends);
}

double between(double a, double b, double share) {
    if (!(a > 0 && b > 0)) return a + share * (b - a);
    return a * static_cast<double>(exp(static_cast<float>(share) * log(static_cast<float>(b / a))));
}

/// Returns the last solution that was ready after `seconds`; nothing if none was.
std::optional<TransportFigures> solved_by(const Repetition& repetition, double seconds) {
    std::optional<TransportFigures> last;
    for (const TransportFigures& one : repetition) {
        if (one.seconds <= seconds) last = one;
    }
    return last;
}

std::optional<TransportFigures> at_time(const Repetition& repetition, double seconds) {
    for (std::size_t i = 0; i < repetition.size(); ++i) {
        const TransportFigures& b = repetition[i];
        if (seconds > b.seconds) continue;
        if (seconds == b.seconds) return b;
        if (i == 0) return std::nullopt;
        const TransportFigures& a = repetition[i - 1];
        const double made_s = b.made_seconds; // spent once, however many samples follow
        const double share = log_share(seconds - made_s, a.seconds - made_s, b.seconds - made_s);
        return TransportFigures{0, seconds, between(a.rel_mse, b.rel_mse, share), between(a.flip, b.flip, share)};
    }
    return std::nullopt;
}

TransportPoint mean_of(const std::vector<TransportFigures>& all) {
    std::vector<double> seconds, rel_mse, flip;
    for (const TransportFigures& one : all) {
        seconds.push_back(one.seconds), rel_mse.push_back(one.rel_mse), flip.push_back(one.flip);
    }
    double patches = 0;
    for (const TransportFigures& one : all)
        patches += static_cast<double>(one.patches) / static_cast<double>(all.size());
    return {0,      estimate_of(seconds), estimate_of(rel_mse), estimate_of(flip), static_cast<uint32_t>(all.size()),
            patches};
}

template <class Least>
void for_each_end(const TransportScene& scene, bool are_solved, const Least& least) {
    for (const TransportRow& row : scene.rows) {
        if (row.is_solved != are_solved) continue;
        for (const Repetition& repetition : row.repetitions) least(repetition.back());
    }
}

} // namespace

double student_t(uint32_t degrees) {
    constexpr double quantiles[] = {12.7062, 4.3027, 3.1824, 2.7764, 2.5706, 2.4469, 2.3646, 2.3060, 2.2622, 2.2281,
                                    2.2010,  2.1788, 2.1604, 2.1448, 2.1314, 2.1199, 2.1098, 2.1009, 2.0930, 2.0860,
                                    2.0796,  2.0739, 2.0687, 2.0639, 2.0595, 2.0555, 2.0518, 2.0484, 2.0452, 2.0423};
    if (degrees <= std::size(quantiles)) return quantiles[std::max(degrees, 1u) - 1];
    // the first terms of Cornish and Fisher's expansion, with an error below 0.0002 from here on
    constexpr double z = 1.959964;
    return z + (z * z * z + z) / (4.0 * degrees) +
           (5 * z * z * z * z * z + 16 * z * z * z + 3 * z) / (96.0 * degrees * degrees);
}

Estimate estimate_of(std::span<const double> values) {
    double sum = 0, squares = 0;
    for (const double value : values) sum += value;
    const double count = static_cast<double>(values.size()), mean = sum / count;
    if (values.size() < 2) return {mean, std::nullopt};
    for (const double value : values) squares += (value - mean) * (value - mean);
    const double error = std::sqrt(squares / (count - 1) / count);
    return {mean, student_t(static_cast<uint32_t>(values.size() - 1)) * error};
}

std::vector<TransportPoint> points_of(const TransportRow& row) {
    std::vector<TransportPoint> points;
    for (std::size_t i = 0;; ++i) {
        std::vector<TransportFigures> all;
        for (const Repetition& repetition : row.repetitions) {
            if (i < repetition.size()) all.push_back(repetition[i]);
        }
        if (all.empty()) return points;
        points.push_back(mean_of(all));
        points.back().samples = all.front().samples;
    }
}

namespace {

/// Returns the number of samples at a time between two figures. Samples grow linearly with time; preparation before the
/// first sample takes time too and belongs to the first figure.
double samples_at(const Repetition& repetition, double seconds) {
    const auto after = std::ranges::find_if(repetition, [&](const auto& f) { return f.seconds >= seconds; });
    if (after == repetition.begin()) return after->samples;
    const TransportFigures& before = *std::prev(after);
    if (after == repetition.end() || after->seconds <= before.seconds) return before.samples;
    const double share = (seconds - before.seconds) / (after->seconds - before.seconds);
    return before.samples + share * (static_cast<double>(after->samples) - before.samples);
}

} // namespace

std::optional<TransportPoint> at_time(const TransportRow& row, double seconds) {
    std::vector<TransportFigures> all;
    std::vector<double> samples;
    for (const Repetition& repetition : row.repetitions) {
        const std::optional<TransportFigures> one =
            row.is_solved ? solved_by(repetition, seconds) : at_time(repetition, seconds);
        if (!one) return std::nullopt;
        all.push_back(*one);
        if (row.is_solved) {
            samples.push_back(one->samples);
            continue;
        }
        samples.push_back(samples_at(repetition, seconds));
    }
    if (all.empty()) return std::nullopt;
    TransportPoint point = mean_of(all);
    point.samples = estimate_of(samples).mean;
    return point;
}

double equal_seconds(const TransportScene& scene) {
    double least = 0;
    for (const bool are_solved : {false, true}) {
        if (least > 0) break;
        for_each_end(scene, are_solved, [&](const TransportFigures& end) {
            least = least > 0 ? std::min(least, end.seconds) : end.seconds;
        });
    }
    return least;
}

std::optional<double> efficiency(const TransportPoint& point) {
    const double work = point.rel_mse.mean * point.seconds.mean;
    return work > 0 && std::isfinite(work) ? std::optional(1 / work) : std::nullopt;
}

std::string describe_reference(const TransportReference& reference) {
    if (!reference.file.empty()) return reference.file + "; its own noise is unknown";
    if (!reference.rel_mse) return reference.integrator + "; it was not rendered";
    return fmt::format("{}, {} samples per pixel, {:.3g} s; its own noise: relMSE {:.2g}, HDR-FLIP of one half "
                       "against the other {:.2g}",
                       reference.integrator, reference.samples, reference.seconds, *reference.rel_mse,
                       reference.flip.value_or(0));
}

bool has_findings(const TransportScene& scene) {
    return std::ranges::any_of(scene.rows, [](const TransportRow& row) { return !row.repetitions.empty(); });
}

bool has_findings(const TransportReport& report) {
    return std::ranges::any_of(report.scenes, [](const TransportScene& scene) { return has_findings(scene); });
}

} // namespace pertev
