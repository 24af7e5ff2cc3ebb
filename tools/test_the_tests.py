#!/usr/bin/env python3
"""The test of the tests: breaks the renderer in one known way at a time and sees which tests notice.

Works on a copy of the tree under build-mutations/, which holds only the test files that are named below, with a build
folder of its own (with ccache it takes minutes). Each mutation replaces text that must be there exactly once, so a
patch that no longer applies is found; then the tests named for it run, and each of them must fail. Without a mutation
all of them must pass, and that is tried first.

`tools/test_the_tests.py [NAME ...]` runs the mutations of these names only, `--list` names them all, `--check` tells in
a moment whether all of them still apply. Prints a table, and exits 1 when a mutation went unnoticed by a test named for
it, did not apply or did not build.
"""

import argparse
import os
import pathlib
import re
import shutil
import subprocess
import sys
import time
import xml.etree.ElementTree as ElementTree
from dataclasses import dataclass

ROOT = pathlib.Path(__file__).resolve().parent.parent
WORK = ROOT / "build-mutations"
TREE, BUILD = WORK / "tree", WORK / "tree/build"  # as in a checkout, so that ccache finds what was built there
TIMEOUT_S = 300  # of one test; a mutation may make it hang, which is noticing


@dataclass
class Mutation:
    name: str
    edits: list  # of (file, text that is there once, what replaces it)
    tests: list  # CTest's names; each must notice


def edit(file, old, new):
    return (file, old, new)


MUTATIONS = [
    Mutation("drop a cosine", [edit("src/shading/lobes/diffuse_lobe.h", "(pdf * share * way.near",
                                    "(kInvPi * share * way.near")],
             ["statistical/bsdf_energy", "statistical/glowing_room"]),
    Mutation("a metal without its second lobe",
             [edit("src/shading/lobes/conductor_lobe.h", "(cosine * lost_o * lost_i / lost) * more",
                   "(0.0f * cosine * lost_o * lost_i / lost) * more")],
             ["statistical/bsdf_energy"]),
    Mutation("a metal that is not reciprocal, with the same energy",
             [edit("src/shading/lobes/conductor_lobe.h", "(cosine * lost_o * lost_i / lost) * more",
                   "(cosine * lost_o + 0.0f * lost_i) * more")],
             ["statistical/bsdf_energy"]),
    Mutation("light cut off at the horizon of each triangle",
             [edit("src/shading/shadow_terminator.h", "return tilt < kLeastTilt ? 0.0f : tilt;", "return 0.0f * tilt;")],
             ["statistical/shadow_terminator"]),
    Mutation("a raised direction with the density of the one before",
             [edit("src/render/surface.h", "sample.pdf = sample.pdf / raised.slope;", "")],
             ["statistical/shadow_terminator"]),
    Mutation("a lamp that moves is drawn where it was put",
             [edit("src/shading/light_set.h", "motion.move_back(from_point), b, sample", "from_point, b, sample")],
             ["statistical/motion_blur"]),
    Mutation("a lamp that moves is drawn with the density of one that stands still",
             [edit("src/render/moved_surface.h", "motion.move_back(from_point), motion.move_back(hit_point)",
                   "from_point, hit_point")],
             ["statistical/motion_blur"]),
    Mutation("a surface that turns keeps its shading frame",
             [edit("src/render/moved_surface.h",
                   "frame = {motion.turn(frame.tangent), motion.turn(frame.bitangent), motion.turn(frame.normal)};", "")],
             ["statistical/motion_blur"]),
    Mutation("motion by its two ends alone",
             [edit("src/math/motion_keys.cpp", "if (segments == kMostMotionSegments) return", "return")],
             ["unit/motion_keys", "statistical/motion_blur", "consistency/shutter"]),
    Mutation("a swept box without what lies between the keys",
             [edit("src/math/motion_keys.cpp", "const double margin = bulge +", "const double margin = 0 * bulge +")],
             ["unit/motion_keys"]),
    Mutation("an instance that moves has the box of where it was put",
             [edit("src/accel/bvh/top_level_bvh.cpp", "if (moves) world = swept(world, placed);", "")],
             ["statistical/motion_blur", "consistency/shutter"]),
    Mutation("shadow rays without a time",
             [edit("src/integrators/path/path_loop.cpp", "paths_[asked_[i].path].time}", "kAtRest}")],
             ["consistency/shutter"]),
    Mutation("light let through where the normals disagree",
             [edit("src/render/surface.h", "return same_side(wo, wi) == (wo_local.z * wi_local.z > 0);",
                   "return same_side(wo, wi) || wo_local.z * wi_local.z != 0;")],
             ["statistical/shadow_terminator"]),
    Mutation("glass with its index the wrong way round",
             [edit("src/shading/lobes/dielectric_lobe.h", "return wo.z > 0 ? ior : 1.0f / ior;",
                   "return wo.z > 0 ? 1.0f / ior : ior;")],
             ["statistical/bsdf_energy", "statistical/bsdf_sampling"]),
    Mutation("a layer that takes nothing from what lies beneath",
             [edit("src/shading/lobes/passage.h", "(1.0f - max(at_o, at_i))",
                   "(1.0f - 0.0f * max(at_o, at_i))")],
             ["statistical/bsdf_energy"]),
    Mutation("a layer that looks at the viewer's side alone",
             [edit("src/shading/lobes/passage.h", "(1.0f - max(at_o, at_i))",
                   "(1.0f - at_o - 0.0f * at_i)")],
             ["statistical/bsdf_energy"]),
    Mutation("sheen as bright as its formula",
             [edit("src/shading/lobes/sheen_lobe.h", "way.light * f / max(1.0f, max(albedo_o, albedo_i))",
                   "way.light * f")],
             ["statistical/bsdf_energy"]),
    Mutation("a particle weighted by the shading normal alone",
             [edit("src/render/particle_scatter.h", "return abs(from.direction.z) * there /",
                   "return 1.0f + 0.0f * abs(from.direction.z) * there /")],
             ["statistical/particle_scatter"]),
    Mutation("the density of a metal forgets its second lobe",
             [edit("src/shading/lobes/conductor_lobe.h", "(1.0f - lost_o) * once.pdf + lost_o * pdf_grazing_lobe(i.z, alpha)",
                   "once.pdf")],
             ["statistical/bsdf_sampling"]),
    Mutation("a digit of a coefficient of the sine",
             [edit("src/math/portable_trig.h", "0x1.1106c6p-7f", "0x1.1106d6p-7f")],
             ["unit/portable_math"]),
    Mutation("swap a MIS weight", [edit("src/integrators/path/shade_hit.h", "power_heuristic(light.pdf, scattered.pdf)",
                                        "power_heuristic(scattered.pdf, light.pdf)")],
             ["statistical/path_parts", "statistical/glowing_room"]),
    Mutation("count emission twice beside next-event estimation",
             [edit("src/integrators/path/shade_hit.h", "weight = power_heuristic(path.bsdf_pdf, light_pdf);",
                   "weight = 1;")],
             ["statistical/path_parts", "statistical/glowing_room"]),
    Mutation("lights and bounces that both draw one, without weights",
             [edit("src/restir/draw_candidates.h", "drawn * light.pdf + (light.is_delta ? 0.0f : value.pdf)",
                   "drawn * light.pdf")],
             ["statistical/restir"]),
    Mutation("bounces shared without the ratio of solid angles",
             [edit("src/restir/bounce_reservoir.h", "return seen.measure * (surface.evaluate", "return (surface.evaluate")],
             ["statistical/restir"]),
    Mutation("roulette without compensation",
             [edit("src/integrators/path/shade_hit.h", "path.throughput = (1.0f / survival) * path.throughput;", "")],
             ["statistical/glowing_room"]),
    Mutation("one scattering too many", [edit("src/integrators/path/shade_hit.h", "path.depth >= settings.max_depth",
                                              "path.depth > settings.max_depth")],
             ["statistical/glowing_room"]),
    Mutation("origins that are moved along the normal alone",
             [edit("src/render/surface.h", "keep_off_edges(hit.u, hit.v, min(least, 0.25f))",
                   "keep_off_edges(hit.u, hit.v, 0.0f * least)")],
             ["robust/light_leak", "unit/hit_error"]),
    Mutation("a light that stays where the file has it, in a world that is moved",
             [edit("src/shading/build_light_set.cpp", "light.position - centre", "light.position")],
             ["consistency/moved_world", "unit/prepare_scene"]),
    Mutation("a world that is not moved",
             [edit("src/render/prepare_scene.cpp", "options.centre.value_or(world_centre(scene));", "Vec3{};")],
             ["consistency/moved_world", "unit/prepare_scene"]),
    Mutation("a fused product in the source", [edit("src/math/vec3.h", "return a.x * b.x + a.y * b.y + a.z * b.z;",
                                                    "return fma(a.x, b.x, a.y * b.y) + a.z * b.z;")],
             ["consistency/contraction"]),
    Mutation("contraction allowed in one module",
             [edit("src/CMakeLists.txt", "pertev_module(integrators pertev_render)",
                   "pertev_module(integrators pertev_render)\n"
                   "target_compile_options(pertev_integrators PRIVATE -ffp-contract=fast)")],
             ["sources/flags"]),
    Mutation("the first hit of several at one t wins",
             [edit("src/trace/trace_closest.h", "((hit.t == best.t) & lower)", "(lower & false)")],
             ["consistency/walks"]),
    Mutation("boxes are not grown", [edit("src/trace/intersect/ray_boxes.h", "return 0x1p-20f * (", "return 0.0f * (")],
             ["consistency/walks", "robust/watertight"]),
    # Grown boxes hide it from hits: an entry is less than the t of a hit inside. The rule itself is what a test sees.
    Mutation("a node at equal t is skipped",
             [edit("src/trace/intersect/ray_boxes.h", "return entry <= exit;", "return entry < exit;"),
              edit("src/trace/wide/walk_wide.h", "_mm256_cmp_ps(entries, exit, _CMP_LE_OQ)",
                   "_mm256_cmp_ps(entries, exit, _CMP_LT_OQ)")],
             ["unit/walk_tree"]),
    Mutation("a closest hit lies 1e-4 too far",
             [edit("src/trace/trace_closest.h", "    hit = visitor.best;", "    hit = visitor.best;\n    hit.t *= 1.0001f;")],
             ["robust/embree"]),
    Mutation("any hit looks past t_max", [edit("src/trace/trace_any.h", "    walk_scene<Walk>(scene, ray, visitor, counter);",
                                               "    Ray longer = ray;\n    longer.t_max = visitor.t_max = kInfinity;\n"
                                               "    walk_scene<Walk>(scene, longer, visitor, counter);")],
             ["consistency/walks"]),
    Mutation("quantised boxes are not grown",
             [edit("src/trace/intersect/compressed_boxes.h", "fma(0x1p-7f, s, grow)", "fma(-0.5f, s, grow)")],
             ["consistency/wide_walks"]),
    Mutation("the entry of a compressed walk's group is rounded up",
             [edit("src/trace/intersect/compressed_boxes.h", "(min(b, c))) * end) >> 16;", "(min(b, c))) * end) >> 16) + 1;"),
              edit("src/trace/intersect/compressed_boxes.h", "return bits_of(float_of(", "return (bits_of(float_of(")],
             ["consistency/wide_walks"]),
    Mutation("a group's entry leaves out a slot that waits",
             [edit("src/trace/intersect/compressed_boxes.h", "const int c = min(min(a, at(6)), at(7));",
                   "const int c = min(a, at(6));")],
             ["consistency/wide_walks"]),
    Mutation("the restart trail forgets which child it took",
             [edit("src/trace/binary/restart_trail_walk.h", "second = (trail.taken & bit) != 0;", "second = enters1;")],
             ["consistency/binary_walks"]),
    Mutation("a cut triangle's boxes are not rounded outwards",
             [edit("src/accel/bvh/cut_triangle.h",
                   "lo[k] = static_cast<float>(at - off), hi[k] = static_cast<float>(at + off);",
                   "lo[k] = static_cast<float>(at + off), hi[k] = static_cast<float>(at - off);")],
             ["unit/bvh_builders"]),
    Mutation("a fetch counts lanes that have a ray already",
             [edit("src/trace/warps/dynamic_fetch.h", "count_lanes(idle & lanes_before())", "count_lanes(lanes_before())")],
             ["consistency/emulated_warps"]),
    Mutation("a refill drops triangles that were put off",
             [edit("src/trace/wide/compressed_walk.h", "            } else {\n                return;\n            }",
                   "            }")],
             ["consistency/emulated_warps"]),
    Mutation("a packet votes with whoever is there",
             [edit("src/trace/binary/warp_packet_walk.h", "if (ballot(packet, takes_part) != 0) return top.link;",
                   "if (ballot(lanes_here(), takes_part) != 0) return top.link;")],
             ["consistency/emulated_warps"]),
    Mutation("a lane leaves its warp as soon as the pool is empty",
             [edit("src/trace/warps/dynamic_fetch.h", "if (ballot(kWarp, index != kNoRay) == 0) return;",
                   "if (pool_is_empty && index == kNoRay) return;")],
             ["consistency/emulated_warps"]),
    Mutation("the laboratory takes every hit for right",
             [edit("src/lab/traced_set.cpp", "here += differs(hits[i], wanted[i], exact) ? 1 : 0;",
                   "here += differs(hits[i], wanted[i], exact) ? 0 : 0;")],
             ["consistency/lab"]),
    Mutation("an instance's ray is renormalised",
             [edit("src/trace/scene_trees.h", "transform_vector(local_from_world, ray.direction),",
                   "normalize(transform_vector(local_from_world, ray.direction)),")],
             ["unit/trace_instance"]),
    Mutation("accept does not look at alpha", [edit("src/render/accept_hit.h",
                                                    "if (placed.has_alpha == 0) return true;",
                                                    "if (placed.has_alpha <= 1) return true;")],
             ["unit/accept_hit"]),
    Mutation("a ray meets the triangle it leaves",
             [edit("src/render/accept_hit.h",
                   "if (instance == start.instance && primitive == start.primitive) return false;", "")],
             ["unit/accept_hit"]),
    Mutation("wrong density of the environment",
             [edit("src/shading/environment_light.h", "(0.25f * kInvPi) / (row_bounds.y - row_bounds.x)",
                   "(0.25f * kInvPi) * 1.02f / (row_bounds.y - row_bounds.x)")],
             ["statistical/environment_sampling"]),
    Mutation("the density of a light forgets its choice",
             [edit("src/shading/light_set.h", "triangle_pdf(normal, wi, distance_squared) * triangle.pmf",
                   "triangle_pdf(normal, wi, distance_squared)")],
             ["statistical/light_sampling", "statistical/glowing_room"]),
    Mutation("scattered strata: the light is drawn by a number out of order",
             [edit("src/shading/light_set.h", "draw_ordered(view.choice, u.x, more)",
                   "draw_ordered(view.choice, hash_word(u.x), more)"),
              edit("src/shading/light_set.h", "draw_ordered(view.triangles_of(source.index), u.y, more)",
                   "draw_ordered(view.triangles_of(source.index), hash_word(u.y), more)")],
             ["statistical/light_strata"]),
    Mutation("scattered strata: the environment's rows are drawn out of order",
             [edit("src/shading/environment_light.h", "draw_ordered(view.rows, u.y, more)",
                   "draw_ordered(view.rows, hash_word(u.y), more)")],
             ["statistical/light_strata"]),
    Mutation("scattered strata: triangles of a lamp in the order of the file",
             [edit("src/shading/build_light_set.cpp", "if (const Row row = find_row(points); row.is_straight) {",
                   "if (points.size() > 1) return order;\n    if (const Row row = find_row(points); row.is_straight) {")],
             ["statistical/light_strata"]),
    Mutation("a bounce and the light behind it are drawn by different groups",
             [edit("src/integrators/path/path_state.h", "vertex_group(path, kGroupScatter) - kGroupsPerVertex",
                   "vertex_group(path, kGroupScatter) + 1000")],
             ["statistical/light_strata"]),
    Mutation("a lamp shines from both faces",
             [edit("src/shading/light_set.h", "return is_two_sided != 0 ||", "return is_two_sided != 0 || true ||"),
              edit("src/render/surface.h", "(material.two_sided_emission || dot(triangle.normal, direction) < 0)",
                   "(material.two_sided_emission || dot(triangle.normal, direction) < 2)")],
             ["statistical/light_sampling", "statistical/lamp_faces"]),
    Mutation("the front of a mirrored lamp is turned over",
             [edit("src/shading/build_light_set.cpp", "triangle.is_mirrored = is_mirrored ? 1 : 0;",
                   "triangle.is_mirrored = is_mirrored ? 0 : 0;")],
             ["statistical/light_sampling", "statistical/lamp_faces"]),
    Mutation("the clamp cuts what BSDF sampling finds one scattering earlier",
             [edit("src/integrators/path/shade_hit.h", "clamp_contribution(settings, path.depth, weight,",
                   "clamp_contribution(settings, path.depth + 1, weight,")],
             ["statistical/lamp_faces"]),
    Mutation("the clamp cuts what next-event estimation finds one scattering earlier",
             [edit("src/integrators/path/shade_hit.h", "clamp_contribution(settings, path.depth + 1, weight,",
                   "clamp_contribution(settings, path.depth + 2, weight,")],
             ["statistical/lamp_faces"]),
    Mutation("the clamp comes after the weight",
             [edit("src/integrators/path/shade_hit.h", "limit = weight * settings.clamp;",
                   "limit = settings.clamp + 0.0f * weight;")],
             ["statistical/lamp_faces"]),
    Mutation("a packet forgets where its first rays start",
             [edit("src/trace/wide/wide_packet.h", "max(all.most_near, most_of(q_near))", "most_of(q_near)")],
             ["consistency/trace_many"]),
    Mutation("a hit in flight drops one that waits too many",
             [edit("src/trace/wide/flight_stack.h", "(1u << (size_ - i)) - 1", "(1u << (size_ - i - 1)) - 1")],
             ["consistency/trace_many"]),
    Mutation("light passes the backs that the camera looks through",
             [edit("src/integrators/path/path_loop.cpp", "from_camera && picture_.scene.any_hidden_back != 0",
                   "picture_.scene.any_hidden_back != 0")],
             ["unit/hidden_back"]),
    Mutation("hidden backs are those of the world's winding",
             [edit("src/render/accept_hit.h", "transform_vector(placed.local_from_world, at_rest)) > 0;",
                   "transform_vector(placed.local_from_world, at_rest)) *\n"
                   "                   (placed.is_mirrored != 0 ? -1.0f : 1.0f) > 0;")],
             ["unit/hidden_back"]),
    Mutation("the film loses a carry", [edit("src/render/fixed_sum.h",
                                             "value.high += old + value.low < old ? 1 : 0;",
                                             "static_cast<void>(old);")],
             ["unit/fixed_sum", "unit/film"]),
    Mutation("an invalid sample is added", [edit("src/render/film_view.h", "return abs(x) <= kMaxSampleValue;",
                                                 "return !(abs(x) > kInfinity);")],
             ["unit/film"]),
    Mutation("half a pixel off", [edit("src/render/camera_rays.h",
                                       "static_cast<float>(pixel % width) + 0.5f + offset.x",
                                       "static_cast<float>(pixel % width) + offset.x")],
             ["unit/first_hit"]),
    Mutation("a pixel filter of another width", [edit("src/render/pixel_filter.cpp", "exp(-4.5f * x * x)",
                                                      "exp(-4.4f * x * x)")],
             ["unit/pixel_filter"]),
    Mutation("rays start on the wrong side", [edit("src/render/ray_origin.h", "dot(direction, normal) < 0 ?",
                                                   "dot(direction, normal) > 0 ?")],
             ["unit/ray_origin"]),
    Mutation("the wavefront draws other numbers", [edit("src/integrators/path/path_stages.h",
                                                        "round->first_sample + (", "1 + round->first_sample + (")],
             ["consistency/one_picture"]),
    Mutation("a tree of rays leaves out refraction", [
        edit("src/integrators/ray_tree/tree_vertex.h",
             "follow_delta(branches.refraction, wo_local, branches.refracted, Branch::Refraction, least);", "")],
             ["unit/whitted"]),
    Mutation("a tree's vertex asks four lights alone", [
        edit("src/integrators/ray_tree/tree_stages.h", "min(all, first_shadow + kShadowsAtOnce)",
             "min(all, kShadowsAtOnce)")], ["unit/whitted"]),
    Mutation("a lamp that a glossy surface sees counts twice", [
        edit("src/integrators/ray_tree/tree_vertex.h",
             "f = f - (1.0f - power_heuristic(sample.pdf, all.pdf)) * glossy;", "static_cast<void>(glossy);")],
             ["statistical/distributed"]),
    Mutation("a pair of vertices forgets the ways that the particle knows", [
        edit("src/integrators/bidirectional/eye_stages.h",
             "mis_weight(squared_density(by_eye) * ends[1].mis.others(particle.backwards_density) +",
             "mis_weight(0 * squared_density(by_eye) * ends[1].mis.others(particle.backwards_density) +")],
             ["statistical/bidirectional"]),
    Mutation("layers pass all light on to a mirror beneath", [
        edit("src/shading/bsdf.h", "light_through(bsdf, i, wo, {-wo.x, -wo.y, wo.z}) * one.mirror", "one.mirror")],
             ["unit/bsdf_specular"]),
    Mutation("materials are taken for plain that let rays pass", [
        edit("src/shading/material_view.h", "m.alpha_mode == AlphaMode::Opaque && ", "")], ["consistency/one_picture"]),
    Mutation("boxes above where a subtree was put stay as they were", [
        edit("src/accel/bvh/reinsert_subtrees.cpp", "{parent_[joint], joint, parent_[moves[i].target]}",
             "{parent_[joint], joint, joint}")], ["unit/reinsert_subtrees"]),
    Mutation("the film adds floats", [edit("src/render/film_view.h", "atomic_add(&sums[0], to_fixed(radiance.r));",
                                           "sums[0] = to_fixed(mean_of(sums[0], 1) + radiance.r);")],
             ["unit/film"]),
    Mutation("the light meter looks into lamps", [edit("src/session/meter_exposure.cpp",
                                                       "lamps = light_of(&emitted.pixels[i])",
                                                       "lamps = 0.0f * light_of(&emitted.pixels[i])")],
             ["unit/meter_exposure"]),
    Mutation("the light meter takes the picture's samples", [edit("src/session/meter_exposure.cpp",
                                                                  "meter.path.seed = 0;", "static_cast<void>(0);")],
             ["unit/meter_exposure"]),
    Mutation("a session keeps samples of the picture before", [edit("src/session/session.cpp",
                                                                    "if (film_ && film_is_old_) film_->clear();", "")],
             ["consistency/session", "unit/session"]),
    Mutation("a session's camera is not the new one's", [edit("src/session/session.cpp", "    camera_ = camera;\n", "")],
             ["consistency/session"]),
    Mutation("a session begins each call at sample 0", [edit("src/session/session.cpp",
                                                             "integrator_->render(first + done,",
                                                             "integrator_->render(done,")],
             ["consistency/session"]),
    Mutation("a session forgets that a size changes the view", [edit("src/session/session.cpp",
                                                                     "hidden_back_share_.reset();\n    settings_ =",
                                                                     "static_cast<void>(0);\n    settings_ =")],
             ["unit/session"]),
    Mutation("the filter's table is not told from another's", [edit("src/render/filter_table.h", "filter != held_",
                                                                    "!held_")],
             ["consistency/session"]),
    Mutation("new settings take new queues", [edit("src/integrators/make_integrator.cpp", "from.integrator != to.integrator ||",
                                                   "from.path != to.path ||")],
             ["unit/session"]),
    Mutation("each frame copies every tree to the device anew",
             [edit("src/render/tracer/structure_on_device.cpp", "before->offset_of(bytes.data()) == array.offset", "false")],
             ["unit/structure_on_device"]),
    Mutation("each frame copies the environment to the device anew",
             [edit("src/render/scene_on_device.cpp", "(parts & kPartEnvironment) != 0", "(parts & kPartLights) != 0")],
             ["unit/session"]),
    Mutation("highlights burn", [edit("src/image/auto_exposure.cpp", "constexpr double kBurntShare = 0.005;",
                                      "constexpr double kBurntShare = 0.5;")],
             ["unit/auto_exposure"]),
    Mutation("rotations that go the longer way",
             [edit("src/scene/sample_channel.cpp", "a.w * b.w < 0 ? -1.0f : 1.0f", "a.w * b.w < 0 ? 1.0f : 1.0f")],
             ["unit/sample_channel"]),
    Mutation("tangents of a spline that know nothing of the time between the keys",
             [edit("src/scene/sample_channel.cpp", "seconds * (t3 - 2 * t2 + t) * out", "(t3 - 2 * t2 + t) * out")],
             ["unit/sample_channel"]),
    Mutation("normals that go with a skin as directions do",
             [edit("src/scene/deform_vertices.h", "return determinant(m) < 0 ? -moved : moved;",
                   "return determinant(m) == 0 ? moved : transform_vector(m, n);")],
             ["unit/posed_scene"]),
    Mutation("a frame with the vertices of the one before",
             [edit("src/render/update_scene.cpp", "parts |= kPartGeometry;", "parts |= kPartTrees;")],
             ["consistency/moving_scene", "consistency/update_scene"]),
    Mutation("what is hidden gives light",
             [edit("src/shading/build_light_set.cpp", "if (instance.is_hidden || !is_light(", "if (!is_light(")],
             ["consistency/moving_scene"]),
]


def tracked_files():
    listed = subprocess.run(["git", "ls-files", "-z", "--cached", "--others", "--exclude-standard"], cwd=ROOT,
                            check=True, capture_output=True).stdout.decode().split("\0")
    return [name for name in listed if name and (ROOT / name).is_file()]


def test_names(mutations):
    return sorted({test for mutation in mutations for test in mutation.tests})


def wanted(name, tests):
    """All but the test files that no mutation names."""
    return not name.endswith("_test.cpp") or name[len("tests/"):-len("_test.cpp")] in tests


def apply(edits, contents):
    """Makes the edits in `contents`, bytes by name. Returns what does not apply."""
    for file, old, new in edits:
        count = contents.get(file, b"").count(old.encode())
        if count != 1:
            return f"{file} has {count} times: {old}"
        contents[file] = contents[file].replace(old.encode(), new.encode())
    return None


def check_that_all_apply():
    """Exits 1 when one does not."""
    good = True
    for mutation in MUTATIONS:
        files = {file for file, _, _ in mutation.edits if (ROOT / file).is_file()}
        problem = apply(mutation.edits, {file: (ROOT / file).read_bytes() for file in files})
        if problem:
            good = False
            print(f"{mutation.name}: does not apply: {problem}")
    sys.exit(0 if good else 1)


def write_tree(edits, tests):
    """Brings the copy to the tree's content with `edits` made; files that are right already keep their times. Returns
    what does not apply."""
    contents = {name: (ROOT / name).read_bytes() for name in tracked_files() if wanted(name, tests)}
    problem = apply(edits, contents)
    if problem:
        return problem
    for path in list(TREE.rglob("*")):
        if path.is_file() and BUILD not in path.parents and str(path.relative_to(TREE)) not in contents:
            path.unlink()
    for name, content in contents.items():
        path = TREE / name
        if not path.is_file() or path.read_bytes() != content:
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_bytes(content)
            shutil.copymode(ROOT / name, path)
    return None


def build(jobs, tests):
    """Error text, or nothing."""
    environment = {**os.environ, "CCACHE_BASEDIR": str(TREE), "CCACHE_NOHASHDIR": "1"}
    launcher = ["-DCMAKE_CXX_COMPILER_LAUNCHER=ccache"] if shutil.which("ccache") else []
    steps = [["cmake", "-G", "Ninja", "-S", TREE, "-B", BUILD, "-DPERTEV_CUDA=OFF", *launcher]]
    if any(not test.startswith("sources/") for test in tests):
        steps.append(["cmake", "--build", BUILD, "-j", str(jobs), "--target", "pertev_tests"])
    for step in steps:
        done = subprocess.run(step, env=environment, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, check=False)
        if done.returncode != 0:
            return done.stdout.decode(errors="replace")[-2000:]
    return None


def failed_tests(tests):
    """Those of `tests` that fail."""
    report = WORK / "report.xml"
    report.unlink(missing_ok=True)
    environment = {name: value for name, value in os.environ.items() if not name.startswith("PERTEV_")}
    pattern = "^(" + "|".join(map(re.escape, tests)) + ")$"
    subprocess.run(["ctest", "--test-dir", BUILD, "-R", pattern, "--timeout", str(TIMEOUT_S), "--output-junit", report],
                   env=environment, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, check=False)
    status = {case.get("name"): case.get("status") for case in ElementTree.parse(report).getroot().iter("testcase")}
    missing = [test for test in tests if test not in status]
    if missing:
        sys.exit(f"CTest has no test named {', '.join(missing)}")
    return [test for test in tests if status[test] != "run"]


def try_mutation(mutation, all_tests, jobs):
    """(whether all is well, what to say)"""
    problem = write_tree(mutation.edits, all_tests)
    if problem:
        return False, "does not apply: " + problem
    problem = build(jobs, mutation.tests)
    if problem:
        return False, "does not build:\n" + problem
    failed = failed_tests(mutation.tests)
    blind = [test for test in mutation.tests if test not in failed]
    text = ("noticed by " + ", ".join(failed)) if failed else "noticed by none"
    return not blind, text + ("; NOT by " + ", ".join(blind) if blind else "")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("names", nargs="*", help="mutations to try; all where none is named")
    parser.add_argument("--list", action="store_true", help="name the mutations and the tests that must notice")
    parser.add_argument("--check", action="store_true", help="only see whether all mutations still apply")
    parser.add_argument("--jobs", type=int, default=os.cpu_count(), help="compilers at once")
    arguments = parser.parse_args()
    if arguments.check:
        check_that_all_apply()
    unknown = set(arguments.names) - {mutation.name for mutation in MUTATIONS}
    if unknown:
        sys.exit(f"no mutation is named {', '.join(map(repr, sorted(unknown)))}; --list names them")
    mutations = [m for m in MUTATIONS if not arguments.names or m.name in arguments.names]
    if arguments.list:
        for mutation in mutations:
            print(f"{mutation.name}: {', '.join(mutation.tests)}")
        return

    all_tests, tests = test_names(MUTATIONS), test_names(mutations)
    write_tree([], all_tests)
    problem = build(arguments.jobs, tests)
    if problem:
        sys.exit("the tree does not build without a mutation:\n" + problem)
    failed = failed_tests(tests)
    if failed:
        sys.exit("these tests fail without a mutation: " + ", ".join(failed))

    good = True
    width = max(len(mutation.name) for mutation in mutations)
    for mutation in mutations:
        start = time.monotonic()
        ok, text = try_mutation(mutation, all_tests, arguments.jobs)
        good &= ok
        print(f"{'ok    ' if ok else 'FAILED'} {mutation.name:{width}}  {text}  [{time.monotonic() - start:.0f} s]",
              flush=True)
    write_tree([], all_tests)
    sys.exit(0 if good else 1)


if __name__ == "__main__":
    main()
