#include "scene/validate/validate_parts.h"

#include <fmt/format.h>

#include "base/error.h"
#include "base/limits.h"
#include "base/message_text.h"

namespace pertev {
namespace {

constexpr float kMaxUvScale = 0x1p40f;

class Checker {
public:
    Checker(Scene& scene, const std::string& file, Sink& sink) : scene_(scene), file_(file), sink_(sink) {}

    void run() {
        for (std::size_t i = 0; i < scene_.images.size(); ++i) image(i);
        for (std::size_t i = 0; i < scene_.materials.size(); ++i) material(i);
        if (clamped_ > 0) {
            sink_.warn(
                {FileLocation{file_}, fmt::format("{} of materials outside the range {} clamped; the first is {}",
                                                  counted(clamped_, "number"), is_or_are(clamped_), first_clamped_)});
        }
        if (scene_.environment) environment(*scene_.environment);
    }

private:
    Error bad(const std::string& what) const { return Error(ErrorCode::BadInput, FileLocation{file_}, what); }

    void check_size(uint64_t width, uint64_t height, uint64_t values, uint64_t values_per_pixel,
                    const std::string& of) const {
        if (width == 0 || height == 0) throw bad(of + ": it has no pixels");
        if (width > kMaxImageSide || height > kMaxImageSide || width * height > kMaxImagePixels) {
            throw Error(ErrorCode::OverLimit, FileLocation{file_},
                        fmt::format("{}: {} x {} pixels; the limits are {} per side and {} per image", of, width,
                                    height, kMaxImageSide, kMaxImagePixels));
        }
        if (values != width * height * values_per_pixel) {
            throw bad(fmt::format("{}: {} x {} pixels, but {} values", of, width, height, values));
        }
    }

    /// Replaces values that are not finite or below `least` by 0.
    void clean(std::vector<float>& pixels, float least, const std::string& of) {
        std::size_t bad_values = 0;
        for (float& value : pixels) {
            if (is_finite(value) && value >= least) continue;
            value = 0;
            ++bad_values;
        }
        if (bad_values > 0) {
            sink_.warn({FileLocation{file_},
                        fmt::format("{}: {} negative or not finite: set to 0", of, counted(bad_values, "value"))});
        }
    }

    void image(std::size_t i) {
        TextureImage& image = scene_.images[i];
        const std::string of = numbered("image", i, image.name);
        if (image.rgba_float.pixels.empty()) {
            check_size(image.rgba8.width, image.rgba8.height, image.rgba8.pixels.size(), 4, of);
            return;
        }
        if (!image.rgba8.pixels.empty()) throw bad(of + ": it has both 8-bit and float pixels");
        check_size(image.rgba_float.width, image.rgba_float.height, image.rgba_float.pixels.size(), 4, of);
        if (image.rgba_float.channels != 4) throw bad(of + ": expected 4 channels of a float texture");
        clean(image.rgba_float.pixels, -kMaxSampleValue, of);
    }

    void environment(Environment& environment) {
        if (!environment.image.pixels.empty()) {
            check_size(environment.image.width, environment.image.height, environment.image.pixels.size(), 3,
                       "environment");
            if (environment.image.channels != 3) throw bad("environment: expected 3 channels");
            clean(environment.image.pixels, 0, "environment");
        }
        const Rgb scale = environment.scale;
        if (!(is_finite(scale) && scale.r >= 0 && scale.g >= 0 && scale.b >= 0 && is_finite(environment.rotation))) {
            throw bad("environment: expected a finite rotation and a finite scale of at least 0");
        }
    }

    void material(std::size_t i) {
        Material& m = scene_.materials[i];
        of_ = numbered("material", i, m.name, m.origin);
        visit_parameters(
            m, [&](auto&&... row) { number(row...); }, [&](auto&&... row) { texture(row...); });
    }

    void number(float& value, const char* name, float lo, float hi) {
        if (!is_finite(value)) throw bad(fmt::format("{}: {} is {}; expected a finite number", of_, name, value));
        if (value >= lo && value <= hi) return;
        if (clamped_++ == 0)
            first_clamped_ = fmt::format("{} of {}, {}, kept within {} and {}", name, of_, value, lo, hi);
        value = clamp(value, lo, hi);
    }

    void texture(const TextureRef& ref, const char* name) {
        if (ref.image == kNoImage) return;
        if (ref.image < 0 || static_cast<std::size_t>(ref.image) >= scene_.images.size()) {
            throw bad(fmt::format("{}: {}: image {} is out of range; there are {}", of_, name, ref.image,
                                  scene_.images.size()));
        }
        if (ref.uv_set >= kTextureSets)
            throw bad(fmt::format("{}: {}: set {} of texture coordinates; expected less than {}", of_, name, ref.uv_set,
                                  kTextureSets));
        if (ref.channel > 3) throw bad(fmt::format("{}: {}: channel {}; expected 0 to 3", of_, name, ref.channel));
        for (const float m : {ref.m00, ref.m01, ref.m02, ref.m10, ref.m11, ref.m12}) {
            if (!(abs(m) <= kMaxUvScale)) throw bad(fmt::format("{}: {}: its transform is not finite", of_, name));
        }
    }

    Scene& scene_;
    const std::string& file_;
    Sink& sink_;
    std::string of_; // the current material
    std::size_t clamped_ = 0;
    std::string first_clamped_;
};

} // namespace

void validate_materials(Scene& scene, const std::string& file, Sink& sink) { Checker(scene, file, sink).run(); }

} // namespace pertev
