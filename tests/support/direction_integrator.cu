#include "tests/support/direction_integrator.h"

#include "device/launch_body.h"
#include "math/sampler.h"

// The path tracer is not among what was included: with a second visible class of this name, the last line would be
// ambiguous and not compile.
struct PathIntegrator;
using namespace pertev;
static_assert(sizeof(PathIntegrator*) > 0);

namespace pertev::test {
namespace {

struct AddDirections {
    CameraRays camera;
    uint32_t first, count; // samples
    FilmView film;

    HD void operator()(uint32_t slot) const {
        const uint32_t pixel = film.window.pixel_at(FilmSlot{slot});
        for (uint32_t sample = first; sample < first + count; ++sample) {
            const Vec2 in_filter = sample_2d(SamplerKind::Sobol, {pixel, sample, 0}, 0);
            const Vec3 d = camera.line(camera.corner_of(pixel), in_filter, Vec2{0.5f, 0.5f}).direction;
            add_radiance(film, pixel, {0.5f + 0.5f * d.x, 0.5f + 0.5f * d.y, 0.5f + 0.5f * d.z});
        }
    }
};

} // namespace

void DirectionIntegrator::begin(const PictureView& picture, SceneTracer&, uint32_t) {
    picture_ = picture;
    rays_ = {};
}

void DirectionIntegrator::render(uint32_t first, uint32_t count, const FilmView& film) {
    const uint32_t pixels = film.window.count();
    launch(queue_, "add_directions", pixels, AddDirections{picture_.camera, first, count, film});
    rays_.camera += uint64_t(pixels) * count;
    queue_.wait();
}

} // namespace pertev::test
