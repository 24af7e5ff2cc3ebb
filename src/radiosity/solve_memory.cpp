#include "radiosity/solve_memory.h"

#include <algorithm>
#include <bit>

#include <fmt/format.h>

#include "base/error.h"
#include "base/machine_memory.h"
#include "radiosity/corner_table.h"
#include "radiosity/hierarchical.h"
#include "radiosity/radiosity_system.h"
#include "radiosity/row_maker.h"
#include "radiosity/solve_radiosity.h"

namespace pertev {
namespace {

using Parts = std::vector<SolveMemory::Part>;

struct Counts {
    uint64_t patches, shown, triangles, vertices;
};

std::size_t sum_of(const Parts& parts) {
    std::size_t sum = 0;
    for (const SolveMemory::Part& part : parts) sum += part.bytes;
    return sum;
}

std::size_t tree_bytes(uint64_t patches, uint64_t triangles) {
    return patches * sizeof(Patch) + (patches / 3 + 1) * sizeof(PatchQuad) + 2 * triangles * sizeof(PatchCode);
}

/// Number of form factors from which a row is made, before those of one patch are merged.
uint64_t found_factors(const RadiositySettings& s) {
    const uint64_t of_lights = std::max(s.rays / 4, kMinPatchRays);
    return s.form_factors == FormFactors::Rays ? s.rays + of_lights : 3 * uint64_t(s.hemicube) * s.hemicube;
}

/// Memory of threads that make rows: a list that grows by doubling, a copy to sort it, and a hemicube.
Parts making_rows(const RadiositySettings& s, const Counts& counts, uint64_t threads) {
    const std::size_t list = 4 * found_factors(s) * sizeof(FormFactor);
    Parts parts = {{"rows of form factors in progress", threads * (list + 65536)}};
    if (s.form_factors == FormFactors::Hemicube) {
        const uint64_t pixels = uint64_t(s.hemicube) * s.hemicube;
        parts.push_back({"hemicubes: pixels", threads * max_hemicube_bytes(s.hemicube) + 9 * sizeof(double) * pixels});
        parts.push_back({"hemicubes: triangles", counts.triangles * sizeof(HemicubeScene::PlacedCorners)});
    }
    return parts;
}

Parts solving_rows(const RadiositySettings& s, const Counts& counts, uint64_t threads) {
    const uint64_t n = counts.patches, entries = n * std::min(found_factors(s), n);
    Parts making = making_rows(s, counts, threads);
    Parts solving;
    if (s.solver == RadiositySolver::Southwell) {
        solving = {{"form factors by shooting patch", entries * sizeof(FormFactor) + 2 * n * sizeof(uint64_t)},
                   {"unsent light", 2 * std::bit_ceil(n) * sizeof(double) + 2 * n * sizeof(Rgb)}};
    } else if (s.solver == RadiositySolver::Matrix) {
        const uint64_t side = std::min<uint64_t>(n, kMaxMatrixPatches);
        solving = {{"matrix", side * (side + 8) * sizeof(double)}};
    } else {
        solving = {{"radiosities", n * sizeof(Rgb)}};
    }
    Parts parts = sum_of(making) > sum_of(solving) ? making : solving;
    parts.push_back({"form factors", entries * sizeof(FormFactor)});
    parts.push_back(
        {"equations", n * (sizeof(SystemPatch) + 2 * sizeof(Rgb) + sizeof(std::vector<FormFactor>) + kOfAllocation)});
    parts.push_back({"patches", tree_bytes(n, counts.triangles)});
    return parts;
}

/// Memory while patches are divided, and afterwards while the corners' light is found. Lists that grow exist twice for
/// a moment.
Parts showing(const RadiositySettings& s, const Counts& counts, uint64_t threads) {
    Parts parts = s.subdivisions > 0 ? making_rows(s, counts, threads) : Parts{};
    parts.push_back(
        {"shooting patches", tree_bytes(counts.patches, counts.triangles) + 2 * counts.patches * sizeof(Rgb)});
    parts.push_back(
        {"displayed patches", 2 * (tree_bytes(counts.shown, counts.triangles) + counts.shown * sizeof(Rgb)) +
                                  2 * counts.shown * sizeof(uint32_t)});
    parts.push_back({"corners", CornerTable::max_bytes(counts.shown) + WeldedVertices::max_bytes(counts.vertices)});
    parts.push_back({"solution", 2 * counts.shown * sizeof(PatchLight)}); // twice: in memory and as a file
    return parts;
}

} // namespace

SolveMemory predict_memory(const PreparedScene& prepared, const RadiositySettings& settings, int threads) {
    const SolvedScene scene(prepared);
    const SceneView& view = scene.view();
    SolveMemory memory;
    const float patch_size = patch_size_of(prepared, settings);
    const uint64_t all = count_patches(view, patch_size);
    memory.patches = all;
    if (settings.solver == RadiositySolver::Hierarchical) {
        memory.patches = std::min<uint64_t>(memory.patches, kMaxPatches); // fewer patches are divided
    } else {
        check_patch_count(memory.patches, patch_size);
    }
    memory.shown = std::min<uint64_t>(memory.patches << std::min(2 * settings.subdivisions, 30u), kMaxPatches);
    Counts counts = {memory.patches, std::max(memory.shown, memory.patches), view.triangle_count, 0};
    for (const Instance& instance : prepared.scene->instances) {
        counts.vertices += prepared.scene->meshes[instance.mesh].positions.size();
    }
    const auto many = static_cast<uint64_t>(std::max(threads, 1));
    const Parts showing_them = showing(settings, counts, many);
    const bool is_linked = settings.solver == RadiositySolver::Hierarchical;
    const Parts solving = is_linked ? Parts{{"links", max_hierarchical_bytes(counts.patches, counts.triangles)},
                                            {"patches", 2 * tree_bytes(counts.patches, counts.triangles)}}
                                    : solving_rows(settings, counts, many);
    memory.parts = sum_of(solving) > sum_of(showing_them) ? solving : showing_them;
    memory.parts.push_back({"scene", scene.bytes()});
    memory.bytes = sum_of(memory.parts);
    if (is_linked && all <= kMaxPatches) {
        RadiositySettings rows = settings;
        rows.solver = RadiositySolver::GaussSeidel;
        memory.by_rows = std::max(sum_of(solving_rows(rows, counts, many)), sum_of(showing_them)) + scene.bytes();
    }
    std::ranges::stable_sort(memory.parts, std::ranges::greater{}, &SolveMemory::Part::bytes);
    return memory;
}

void check_memory(const SolveMemory& memory, const RadiositySettings& settings, std::size_t limit) {
    if (memory.bytes <= limit) return;
    std::string list;
    for (std::size_t i = 0; i < std::min<std::size_t>(memory.parts.size(), 5); ++i) {
        list += fmt::format("\n  {:10.1f} MiB  {}", mebibytes(memory.parts[i].bytes), memory.parts[i].name);
    }
    const char* fewer = ", fewer `patch_rays` make a smaller system";
    if (settings.solver == RadiositySolver::Hierarchical) {
        fewer = memory.by_rows > 0 && memory.by_rows <= limit ? ", and `solver=gauss-seidel` takes less" : "";
    }
    throw Error(ErrorCode::OutOfMemory, "max_memory", "",
                fmt::format("radiosity may take {:.1f} MiB of this machine's memory; the limit is {:.1f} MiB; a larger "
                            "`patch_size` or fewer `subdivisions` make fewer patches{}. The largest parts:{}",
                            mebibytes(memory.bytes), mebibytes(limit), fewer, list));
}

} // namespace pertev
