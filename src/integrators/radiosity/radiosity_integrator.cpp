#include "integrators/radiosity/radiosity_integrator.h"

#include <span>

#include "integrators/radiosity/radiosity.h"

namespace pertev {

template class RayTreeIntegrator<Radiosity>;

void RadiosityIntegrator::reserve(const WorkSize& size) {
    if (uploaded_ != display_.solution) {
        uploaded_.reset();
        roots_ = {}, quads_ = {}, patches_ = {}; // freed before the new allocations, so that both need not fit
        const RadiositySolution& solution = *display_.solution;
        roots_ = {queue_, std::span<const PatchCode>(solution.roots), "radiosity solution: surfaces"};
        quads_ = {queue_, std::span<const PatchQuad>(solution.quads), "radiosity solution: quads"};
        patches_ = {queue_, std::span<const PatchLight>(solution.patches), "radiosity solution: patches"};
        uploaded_ = display_.solution;
    }
    RayTreeIntegrator::reserve(size);
}

void RadiosityIntegrator::begin(const PictureView& picture, SceneTracer& tracer, uint32_t samples) {
    if (!display_.solution)
        throw Error(ErrorCode::BadInput, "integrator", "radiosity", "there is no solution to display");
    const RadiositySolution& solution = *display_.solution;
    if (picture.scene.first_triangle == nullptr || solution.roots.size() != 2 * picture.scene.triangle_count) {
        throw Error(ErrorCode::BadInput, "integrator", "radiosity", "the solution belongs to another scene");
    }
    RayTreeIntegrator::begin(picture, tracer, samples);
    picture_settings_.radiosity = {{roots_.data(), quads_.data()}, patches_.data(), solution.ambient, display_.is_flat};
}

} // namespace pertev
