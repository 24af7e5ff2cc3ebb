#pragma once

// Surfaces and emitters at the time of a ray while a shutter is open: everything is computed at its position at rest
// and then moved (math/rigid_motion.h). Thus whatever does not move is the same as without a shutter, to the bit.

#include "device_scene/surface.h"

namespace pertev {

/// Compile-time knowledge about motion while the shutter is open. Code for both cases would cost registers, and on a
/// GPU keep surfaces in memory.
enum class MotionVariant : uint8_t { None, Perhaps, Some };

template <MotionVariant kMotion>
HD inline bool is_moving(const SceneView& scene) {
    return kMotion == MotionVariant::Some || (kMotion == MotionVariant::Perhaps && scene.motions.is_there());
}

HD inline void move_surface(const RigidMotion& motion, Surface& surface) {
    const float error = motion.error(surface.position);
    surface.error = motion.rotate_extents(surface.error) + Vec3{error, error, error};
    surface.position = motion.move(surface.position);
    surface.geometric_normal = motion.rotate(surface.geometric_normal);
    Frame& frame = surface.frame;
    frame = {motion.rotate(frame.tangent), motion.rotate(frame.bitangent), motion.rotate(frame.normal)};
}

/// The position of a hit's instance at the ray's time. The surface is made at the position at rest, for the ray moved
/// back there, and then moved:
///     const MovedHit moved(scene, hit, time);
///     Surface surface = make_surface(scene, hit, moved.back(direction));
///     moved.move(surface);
struct MovedHit {
    bool moves;
    RigidMotion motion;

    HD MovedHit(const SceneView& scene, const Hit& hit, float time) {
        const uint32_t number = scene.motions.of(hit.instance);
        moves = number != kNoMotion && time >= 0;
        if (moves) motion = scene.motions.at(number, time);
    }
    HD Vec3 back(Vec3 direction) const { return moves ? motion.rotate_back(direction) : direction; }
    HD void move(Surface& surface) const {
        if (moves) move_surface(motion, surface);
    }
};

/// Positions of emitters at a time, for sample_light and pdf_light_hit.
struct EmittersAt {
    const MotionsView& motions;
    float time;

    HD RigidMotion operator()(uint32_t instance) const { return motions.of_instance_at(instance, time); }
};

/// Samples a light like sample_light, for a scene. `moves` means that something in it moves.
template <EmitterVariant kEmitters = EmitterVariant::Coated, class Choice = ChosenByPower>
HD INLINE_ON_DEVICE bool draw_direct(const SceneView& scene, bool moves, const LightContext& context, SampleBits u,
                                     LightSample& sample) {
    return moves ? sample_light<kEmitters, Choice>(scene.lights, context, u, sample,
                                                   EmittersAt{scene.motions, context.time})
                 : sample_light<kEmitters, Choice>(scene.lights, context, u, sample);
}

/// Density with which draw_direct, for `context`, samples the point of `surface`, 1/sr; 0 if the surface is not an
/// emitter.
template <class Choice = ChosenByPower>
HD inline float pdf_direct(const SceneView& scene, bool moves, const LightContext& context, const Surface& surface) {
    const uint32_t light = light_of(scene.lights, surface.triangle.instance, surface.triangle.primitive);
    if (light == kNoLight) return 0;
    return moves ? pdf_light_hit<Choice>(scene.lights, light, context, surface.position,
                                         EmittersAt{scene.motions, context.time})
                 : pdf_light_hit<Choice>(scene.lights, light, context, surface.position);
}

/// Error that ray_to_light adds for a moving emitter.
HD inline float emitter_error_at(const SceneView& scene, const LightSample& light, float time) {
    if (light.kind() != SourceKind::Triangle || scene.motions.of(light.instance) == kNoMotion) return 0;
    return scene.motions.of_instance_at(light.instance, time).error(light.light_point);
}

} // namespace pertev
