#pragma once

// First stage of direct light: initial candidates. RIS selects one of several sample points on lights and the light
// that the path's first bounce hit.
//
// Source: Bitterli et al. 2020, section 3 and algorithm 3, with candidates of light sampling and one of BSDF sampling
// weighted by the balance heuristic (Wyman et al., "A Gentle Introduction to ReSTIR", SIGGRAPH 2023 courses).

#include "device/per_thread.h"
#include "render/picture_view.h"
#include "restir/light_reservoir.h"
#include "restir/ris_selection.h"
#include "shading/chosen_by_tree.h"

namespace pertev {

/// `Choice` selects lights (shading/light_set.h). A reservoir keeps the point alone, so reuse does not depend on it.
template <ShadingVariant kVariant, class Choice = ChosenByPower>
struct SampleInitialCandidates {
    SceneView scene;
    PixelSurfaces here;
    const EmitterPoint* hit_emitters; // light that the first bounce of each path hit
    LightReservoir* to;
    DiffuseReceiver* receivers; // where those of each pixel are stored, if all materials are diffuse
    uint32_t candidates;

    HD void operator()(uint32_t pixel) const {
        LightReservoir& reservoir = to[pixel];
        reservoir = {};
        if (!here.is_there(pixel)) return;
        const Receiver<kVariant> receiver = here.make_receiver<kVariant>(scene, pixel);
        if constexpr (kVariant == ShadingVariant::Diffuse) receivers[pixel] = receiver;
        if (receiver.is_dark()) return;
        reservoir.count = 1;
        const SampleKey key = here.key(pixel);
        RisSelection selection = {sample_1d(here.sampler, key, kGroupSelectCandidate)};
        const float drawn = static_cast<float>(candidates);
        for (uint32_t k = per_thread(0, receiver.position().x); k < candidates; ++k) {
            const SampleKey candidate = {key.stream, key.sample * candidates + k, key.seed};
            LightSample light;
            if (!sample_light<emitter_variant(kVariant), Choice>(scene.lights, receiver.light_context(),
                                                                 sample_bits(here.sampler, candidate, kGroupCandidates),
                                                                 light)) {
                continue;
            }
            const BsdfValue value = receiver.evaluate(light.wi);
            const float density = drawn * light.pdf + (light.is_delta ? 0.0f : value.pdf);
            if (selection.takes(luminance(value.f * light.radiance) / density)) {
                reservoir.point = point_of(light);
                reservoir.source = 1; // visibility unknown
            }
        }
        LightSample light;
        float measure = 1;
        const EmitterPoint point = hit_emitters[pixel];
        if (find_light<emitter_variant(kVariant)>(scene.lights, point, receiver.light_context(), light, measure)) {
            const BsdfValue value = receiver.evaluate(light.wi);
            if constexpr (Choice::kReadsNormal) {
                light.pdf = pdf_of_found<Choice>(scene.lights, point, receiver.light_context(), light);
            }
            if (selection.takes(luminance(value.f * light.radiance) / (drawn * light.pdf + value.pdf))) {
                reservoir.point = point;
                reservoir.source = 0;
            }
        }
        const float target = luminance(light_scattered(scene, receiver, prepare_light(scene, reservoir)));
        reservoir.weight = target > 0 ? selection.sum / target : 0.0f;
    }
};

} // namespace pertev
