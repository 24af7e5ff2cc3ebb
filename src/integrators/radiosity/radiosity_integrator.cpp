#include "integrators/radiosity/radiosity_integrator.h"

#include <span>

#include "base/error.h"

namespace pertev {
namespace {

template <class T>
Buffer<T> uploaded(Queue& queue, const std::vector<T>& values, const char* name) {
    return {queue, std::span<const T>(values), name};
}

} // namespace

RadiosityIntegrator::RadiosityIntegrator(Queue& queue, const RayTreeSettings& settings, const RadiosityLook& look,
                                         bool in_loop, uint32_t batch)
    : queue_(queue), settings_(settings), look_(look), trees_(queue, settings, in_loop, batch) {}

std::size_t RadiosityIntegrator::predicted_bytes(const RayTreeSettings& settings, const RadiosityLook& look,
                                                 uint64_t samples, uint32_t batch, bool in_loop) {
    const std::size_t trees =
        in_loop ? 0 : RayTreeIntegrator<Radiosity>::predicted_bytes(settings, samples, batch, false);
    return trees + (look.solution ? look.solution->bytes() : 0);
}

void RadiosityIntegrator::begin(const PictureView& picture, SceneTracer& tracer, uint32_t samples) {
    if (!look_.solution) throw Error(ErrorCode::BadInput, "integrator", "radiosity", "there is no solution to show");
    const RadiositySolution& solution = *look_.solution;
    if (picture.scene.first_triangle == nullptr || solution.roots.size() != 2 * picture.scene.triangle_count) {
        throw Error(ErrorCode::BadInput, "integrator", "radiosity", "the solution is of another scene");
    }
    if (uploaded_ != look_.solution) {
        uploaded_.reset();
        roots_ = {}, quads_ = {}, patches_ = {}; // before the new ones, so that both need not fit
        roots_ = uploaded(queue_, solution.roots, "radiosity solution: surfaces");
        quads_ = uploaded(queue_, solution.quads, "radiosity solution: quads");
        patches_ = uploaded(queue_, solution.patches, "radiosity solution: patches");
        solution_bytes_ = solution.bytes();
        uploaded_ = look_.solution;
    }
    RayTreeSettings settings = settings_;
    settings.radiosity = {{roots_.data(), quads_.data()}, patches_.data(), solution.ambient, look_.is_flat};
    trees_.set_settings(settings);
    trees_.begin(picture, tracer, samples);
}

} // namespace pertev
