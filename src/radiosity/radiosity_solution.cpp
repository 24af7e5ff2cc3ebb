#include "radiosity/radiosity_solution.h"

#include <algorithm>
#include <cstring>
#include <fstream>
#include <span>

#include <fmt/format.h>

#include "base/error.h"
#include "base/read_file.h"
#include "base/write_file_atomically.h"

namespace pertev {
namespace {

/// The first bytes of a file; the last letter is the version.
constexpr char kMagic[16] = {'p', 'e', 'r', 't', 'e', 'v', ' ', 'r', 'a', 'd', 'i', 'o', 's', 'i', 't', '3'};
constexpr int kVersion = 3;
constexpr int kFirstWithLight = 2, kFirstWithExtent = 3;

/// The start of a file; its SolvedLight, SolvedExtent, text, roots, quads and patches follow.
struct Header {
    char magic[16];
    uint64_t text, roots, quads, patches; // bytes; elements
    Hash128 geometry, content;            // hashes of the geometry, and of the text, all that follows it and the
                                          // ambient light
    float ambient[3];
    uint32_t unused;
};
static_assert(sizeof(Header) == 96 && sizeof(SolvedLight) == 32 && sizeof(SolvedExtent) == 8);

/// Returns the version of a file; 0 if it is no solution, or of a later version.
int version_of(const Header& header) {
    constexpr std::size_t kName = sizeof kMagic - 1;
    if (std::memcmp(header.magic, kMagic, kName) != 0) return 0;
    const int version = header.magic[kName] - '0';
    return version >= 1 && version <= kVersion ? version : 0;
}

Hash128 content_hash(const RadiositySolution& solution) {
    Hasher hasher;
    const float ambient[] = {solution.ambient.r, solution.ambient.g, solution.ambient.b};
    hasher.add_values(std::span<const float>(ambient));
    hasher.add(std::as_bytes(std::span(solution.made)));
    hasher.add(std::as_bytes(std::span(solution.roots)));
    hasher.add(std::as_bytes(std::span(solution.quads)));
    hasher.add(std::as_bytes(std::span(solution.patches)));
    if (solution.extent != SolvedExtent{}) { // complete ones keep their hash from before there were others
        hasher.add_value(static_cast<uint32_t>(solution.extent.part));
        hasher.add(std::as_bytes(std::span(&solution.extent.left, 1)));
    }
    return hasher.result();
}

[[noreturn]] void refuse_file(const std::filesystem::path& path, const std::string& why) {
    throw Error(ErrorCode::BadInput, FileLocation{path.string()}, why);
}

/// Copies the first of `bytes` to `to` and removes them.
template <class T>
void take(std::span<const std::byte>& bytes, std::span<T> to) {
    if (!to.empty()) std::memcpy(to.data(), bytes.data(), to.size_bytes());
    bytes = bytes.subspan(to.size_bytes());
}

/// Returns whether every lookup ends, at a patch that exists.
bool is_sound(const RadiositySolution& solution) {
    const auto is_code = [&](PatchCode code, std::size_t min_quad) {
        if (code == kNoPatch) return true;
        if (is_patch(code)) return number_of(code) < solution.patches.size();
        return code >= min_quad && code < solution.quads.size();
    };
    const auto is_root = [&](PatchCode code) { return is_code(code, 0); };
    if (!std::ranges::all_of(solution.roots, is_root)) return false;
    for (std::size_t i = 0; i < solution.quads.size(); ++i) {
        for (const PatchCode code : solution.quads[i].child) {
            if (!is_code(code, i + 1)) return false;
        }
    }
    return true;
}

bool is_sound(const SolvedExtent& extent) {
    return extent.part <= SolvedPart::SomeDivided && extent.left >= 0 && extent.left <= 1;
}

bool is_light(Rgb c) { return is_finite(c) && c.r >= 0 && c.g >= 0 && c.b >= 0; }

bool has_light_alone(const RadiositySolution& solution) {
    return is_light(solution.ambient) && std::ranges::all_of(solution.patches, [](const PatchLight& patch) {
               return is_light(patch.mean) && std::ranges::all_of(patch.corner, is_light);
           });
}

} // namespace

Hash128 RadiositySolution::hash() const { return content_hash(*this); }

std::string describe(const SolvedExtent& extent) {
    switch (extent.part) {
    case SolvedPart::All:
        return {};
    case SolvedPart::SomeDirectLight:
        return fmt::format("only direct light, which {:.3g} % of the patches lack", 100 * extent.left);
    case SolvedPart::DirectLight:
        return "only direct light";
    case SolvedPart::SomeBounces:
        return fmt::format("an unfinished solution: its last step changed or left unshot {:.3g} % of the light, and "
                           "patches are not subdivided as requested",
                           100 * extent.left);
    case SolvedPart::SomeDivided:
        return "all light, but patches are not subdivided as requested";
    }
    return {};
}

Hash128 geometry_hash(const Scene& scene) {
    Hasher hasher;
    for (const Mesh& mesh : scene.meshes) {
        hasher.add_value(static_cast<uint64_t>(mesh.positions.size()));
        hasher.add(std::as_bytes(std::span(mesh.positions)));
        hasher.add_value(static_cast<uint64_t>(mesh.indices.size()));
        hasher.add_values(std::span<const uint32_t>(mesh.indices));
    }
    for (const Instance& instance : scene.instances) {
        hasher.add_value(instance.mesh);
        hasher.add_value(instance.material);
        hasher.add_value(static_cast<uint32_t>(instance.is_hidden));
        if (!instance.is_hidden) hasher.add(std::as_bytes(std::span(&instance.world_from_local, 1)));
    }
    return hasher.result();
}

namespace {

/// Throws Error(BadInput) if the solution is not one of `scene` in its present state.
void check_scene(const std::filesystem::path& path, const RadiositySolution& solution, const Scene& scene) {
    uint64_t triangles = 0;
    for (const Instance& instance : scene.instances) triangles += scene.meshes[instance.mesh].triangle_count();
    if (solution.geometry != geometry_hash(scene) || solution.roots.size() != 2 * triangles) {
        refuse_file(path, "a radiosity solution of another scene, of this one before its surfaces were changed, or of "
                          "another `time`; solve the scene again");
    }
    if (!solution.light) return;
    const SolvedLight light = solved_light(scene);
    if (solution.light->surfaces != light.surfaces) {
        refuse_file(
            path,
            "a radiosity solution of this scene with other materials: what surfaces reflect, let through "
            "or emit has changed since, or by `material`, `lamp`, `efficacy` or `two_sided_lights`; solve the scene "
            "again with the same settings");
    }
    if (solution.light->lights != light.lights) {
        refuse_file(path,
                    "a radiosity solution of this scene under other lights: a point, spot or directional light or "
                    "the environment has changed since, or by `lamp`, `environment` and the like, or `time`; solve the "
                    "scene again with the same settings");
    }
}

} // namespace

std::vector<std::byte> bytes_of(const RadiositySolution& solution) {
    Header header = {};
    std::memcpy(header.magic, kMagic, sizeof kMagic);
    header.text = solution.made.size();
    header.roots = solution.roots.size();
    header.quads = solution.quads.size();
    header.patches = solution.patches.size();
    header.geometry = solution.geometry;
    header.content = content_hash(solution);
    header.ambient[0] = solution.ambient.r, header.ambient[1] = solution.ambient.g,
    header.ambient[2] = solution.ambient.b;
    std::vector<std::byte> bytes;
    bytes.reserve(sizeof header + sizeof(SolvedLight) + sizeof(SolvedExtent) + solution.made.size() + solution.bytes());
    const auto append = [&](std::span<const std::byte> more) { bytes.insert(bytes.end(), more.begin(), more.end()); };
    append(std::as_bytes(std::span(&header, 1)));
    PERTEV_CHECK(solution.light.has_value());
    const SolvedLight light = *solution.light;
    append(std::as_bytes(std::span(&light, 1)));
    append(std::as_bytes(std::span(&solution.extent, 1)));
    append(std::as_bytes(std::span(solution.made)));
    append(std::as_bytes(std::span(solution.roots)));
    append(std::as_bytes(std::span(solution.quads)));
    append(std::as_bytes(std::span(solution.patches)));
    return bytes;
}

void write_solution(const std::filesystem::path& path, const RadiositySolution& solution) {
    write_file_atomically(path, bytes_of(solution));
}

bool is_solution(const std::filesystem::path& path) {
    Header header;
    std::ifstream file(path, std::ios::binary);
    return file.read(reinterpret_cast<char*>(&header), sizeof header) && version_of(header) != 0;
}

namespace {

RadiositySolution any_solution_of(const std::span<const std::byte> file, const std::filesystem::path& path) {
    std::span<const std::byte> bytes = file;
    Header header;
    if (bytes.size() < sizeof header) refuse_file(path, "not a radiosity solution");
    take(bytes, std::span(&header, 1));
    const int version = version_of(header);
    if (version == 0) refuse_file(path, "not a radiosity solution");
    constexpr uint64_t kMaxCount = uint64_t(1) << 40; // so that no sum below passes 64 bits
    const bool has_sizes = std::max({header.text, header.roots, header.quads, header.patches}) < kMaxCount;
    const bool has_light = version >= kFirstWithLight, has_extent = version >= kFirstWithExtent;
    const uint64_t before = (has_light ? sizeof(SolvedLight) : 0) + (has_extent ? sizeof(SolvedExtent) : 0);
    const uint64_t size = !has_sizes ? 0
                                     : before + header.text + header.roots * sizeof(PatchCode) +
                                           header.quads * sizeof(PatchQuad) + header.patches * sizeof(PatchLight);
    if (!has_sizes || size != bytes.size()) {
        refuse_file(
            path,
            fmt::format("a radiosity solution that is truncated or damaged: it has {} bytes, but its header states {}",
                        file.size(), sizeof header + size));
    }
    RadiositySolution solution;
    if (has_light) take(bytes, std::span(&solution.light.emplace(), 1));
    if (has_extent) take(bytes, std::span(&solution.extent, 1));
    solution.geometry = header.geometry;
    solution.ambient = {header.ambient[0], header.ambient[1], header.ambient[2]};
    solution.made.resize(header.text);
    solution.roots.resize(header.roots);
    solution.quads.resize(header.quads);
    solution.patches.resize(header.patches);
    take(bytes, std::span(solution.made));
    take(bytes, std::span(solution.roots));
    take(bytes, std::span(solution.quads));
    take(bytes, std::span(solution.patches));
    if (content_hash(solution) != header.content || !is_sound(solution.extent) || !is_sound(solution) ||
        !has_light_alone(solution)) {
        refuse_file(path, "a radiosity solution that is damaged: its content is invalid");
    }
    return solution;
}

} // namespace

RadiositySolution read_any_solution(const std::filesystem::path& path) {
    const std::vector<std::byte> file = read_file(path);
    return any_solution_of(file, path);
}

RadiositySolution solution_of(std::span<const std::byte> bytes, const std::filesystem::path& path, const Scene& scene) {
    RadiositySolution solution = any_solution_of(bytes, path);
    check_scene(path, solution, scene);
    return solution;
}

RadiositySolution read_solution(const std::filesystem::path& path, const Scene& scene, Sink& sink) {
    RadiositySolution solution = read_any_solution(path);
    check_scene(path, solution, scene);
    if (!solution.light) {
        sink.warn({FileLocation{path.string()},
                   "an earlier version made the solution and did not record the scene's light; if lights or "
                   "materials have changed since, it shows the old ones; solve the scene again"});
    }
    if (solution.extent.part != SolvedPart::All) {
        sink.warn({FileLocation{path.string()},
                   fmt::format("the solution is unfinished and contains {}; solve the scene again for all light",
                               describe(solution.extent))});
    }
    return solution;
}

} // namespace pertev
