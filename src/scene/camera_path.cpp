#include "scene/camera_path.h"

#include <algorithm>

namespace pertev {
namespace {

/// A spline through one component of the keys over time.
template <class Number>
class Spline {
public:
    Spline(const std::vector<CameraKey>& keys, const Number& number) : keys_(keys), number_(number) {}

    /// Returns the value at a time between key `before` and the next.
    double at(std::size_t before, double time_s) const {
        const double seconds = time(before + 1) - time(before), t = (time_s - time(before)) / seconds;
        const double t2 = t * t, t3 = t2 * t;
        return (2 * t3 - 3 * t2 + 1) * value(before) + (3 * t2 - 2 * t3) * value(before + 1) +
               seconds * ((t3 - 2 * t2 + t) * slope(before) + (t3 - t2) * slope(before + 1));
    }

private:
    double time(std::size_t key) const { return keys_[key].time_s; }
    double value(std::size_t key) const { return static_cast<double>(number_(keys_[key])); }
    double rise(std::size_t key) const { return (value(key + 1) - value(key)) / (time(key + 1) - time(key)); }
    double slope(std::size_t key) const {
        if (key == 0) return rise(0);
        if (key + 1 == keys_.size()) return rise(key - 1);
        const double before = time(key) - time(key - 1), after = time(key + 1) - time(key);
        return (after * rise(key - 1) + before * rise(key)) / (before + after);
    }

    const std::vector<CameraKey>& keys_;
    const Number& number_;
};

} // namespace

CameraKey sample_path(const CameraPath& path, double time_s) {
    const std::vector<CameraKey>& keys = path.keys;
    const auto above = std::ranges::upper_bound(keys, time_s, {}, &CameraKey::time_s);
    CameraKey now = above == keys.begin() ? keys.front() : *(above - 1);
    now.time_s = time_s;
    if (above == keys.begin() || above == keys.end()) return now;
    const auto before = static_cast<std::size_t>(above - keys.begin()) - 1;
    const auto number = [&](const auto& of) { return Spline(keys, of).at(before, time_s); };
    const auto vector = [&](auto part) {
        return DoubleVec3{number([part](const CameraKey& key) { return (key.*part).x; }),
                          number([part](const CameraKey& key) { return (key.*part).y; }),
                          number([part](const CameraKey& key) { return (key.*part).z; })};
    };
    now.eye = vector(&CameraKey::eye);
    now.target = vector(&CameraKey::target);
    now.up = to_float(vector(&CameraKey::up));
    if (now.fov_deg > 0) {
        const double fov_deg = number([](const CameraKey& key) { return key.fov_deg; });
        now.fov_deg = static_cast<float>(std::clamp(fov_deg, kMinFovDeg, kMaxFovDeg));
    }
    return now;
}

} // namespace pertev
