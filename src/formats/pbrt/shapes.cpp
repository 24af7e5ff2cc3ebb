#include "formats/pbrt/shapes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>

#include <fmt/format.h>

#include "base/message_text.h"
#include "formats/described/finish_meshes.h"
#include "formats/described/transforms.h"
#include "formats/files/closest_name.h"
#include "formats/ply/read_ply.h"
#include "formats/shapes/bilinear_patches.h"
#include "formats/shapes/loop_subdivision.h"
#include "formats/shapes/quadrics.h"

namespace pertev::pbrt {
namespace {

constexpr uint64_t kMostTessellated = uint64_t(1) << 23;

constexpr std::array<std::string_view, 7> kShapeTypes = {"trianglemesh", "plymesh",      "sphere",    "disk",
                                                         "cylinder",     "bilinearmesh", "loopsubdiv"};

Vec3 vec3_at(std::span<const double> numbers, std::size_t i) {
    return to_float(DoubleVec3{numbers[3 * i], numbers[3 * i + 1], numbers[3 * i + 2]});
}

bool has_bad_index(const Mesh& mesh) {
    return std::ranges::any_of(mesh.indices, [&](uint32_t i) { return i >= mesh.positions.size(); });
}

/// Reads indices; one that is no whole number of 32 bits becomes the largest, which no mesh has.
std::vector<uint32_t> indices_of(std::span<const double> numbers) {
    std::vector<uint32_t> indices;
    indices.reserve(numbers.size());
    for (const double number : numbers) {
        const bool is_whole = number >= 0 && number < 4294967295.0 && number == std::floor(number);
        indices.push_back(is_whole ? static_cast<uint32_t>(number) : UINT32_MAX);
    }
    return indices;
}

} // namespace

/// Adds a mesh. Tessellated ones, which are larger than their statements, have a limit together.
ReadShape Shapes::add_mesh(ShapeMesh mesh, bool is_tessellated) {
    if (is_tessellated) tessellated_ += mesh.mesh.triangle_count();
    if (tessellated_ > kMostTessellated) {
        throw Error(ErrorCode::OverLimit, mesh.location,
                    fmt::format("spheres, patches and subdivided meshes have more than {} triangles together",
                                kMostTessellated));
    }
    meshes_.push_back(std::move(mesh));
    return {static_cast<uint32_t>(meshes_.size() - 1), {}};
}

ShapeMesh Shapes::read_vertices(bool is_reversed, Parameters& parameters) {
    Sink& sink = context_.sink;
    ShapeMesh shape;
    shape.location = parameters.location();
    shape.is_reversed = is_reversed;
    Mesh& mesh = shape.mesh;
    const std::span<const double> positions = parameters.numbers("P", 3, sink);
    const std::size_t count = positions.size() / 3;
    if (count == 0) throw parameters.error(fmt::format("{} has no \"point3 P\"", parameters.what()));
    for (std::size_t i = 0; i < count; ++i) {
        shape.exact.push_back({positions[3 * i], positions[3 * i + 1], positions[3 * i + 2]});
        mesh.positions.push_back(to_float(shape.exact.back()));
    }
    const auto fits = [&](const char* name, std::span<const double> numbers, std::size_t size) {
        if (numbers.empty() || numbers.size() == size * count) return !numbers.empty();
        sink.leave_out(
            {parameters.location(), fmt::format("\"{}\" of {} has {} numbers for {} and is left out", name,
                                                parameters.what(), numbers.size(), counted(count, "point"))});
        return false;
    };
    const std::span<const double> normals = parameters.numbers("N", 3, sink);
    if (fits("N", normals, 3)) {
        for (std::size_t i = 0; i < count; ++i) mesh.normals.push_back(vec3_at(normals, i));
    }
    const char* const uv_name = parameters.contains("st") && !parameters.contains("uv") ? "st" : "uv";
    const std::span<const double> uv = parameters.numbers(uv_name, 2, sink);
    if (fits(uv_name, uv, 2)) {
        for (std::size_t i = 0; i < count; ++i)
            mesh.uv[0].push_back({static_cast<float>(uv[2 * i]), 1 - static_cast<float>(uv[2 * i + 1])});
    }
    return shape;
}

ReadShape Shapes::triangle_mesh(bool is_subdivision, bool is_reversed, Parameters& parameters) {
    Sink& sink = context_.sink;
    ShapeMesh shape = read_vertices(is_reversed, parameters);
    Mesh& mesh = shape.mesh;
    mesh.indices = indices_of(parameters.numbers("indices", 3, sink));
    if (mesh.indices.empty() && mesh.positions.size() == 3) mesh.indices = {0, 1, 2};
    if (mesh.indices.empty()) throw parameters.error(fmt::format("{} has no \"integer indices\"", parameters.what()));
    if (has_bad_index(mesh)) {
        throw parameters.error(fmt::format("{} has an index out of range; there are {}, counted from 0",
                                           parameters.what(), counted(mesh.positions.size(), "point")));
    }
    parameters.leave_out({"S"}, "tangents are those of the texture coordinates", sink);
    parameters.ignore({"faceIndices", "edgelength"});
    if (is_subdivision) {
        const char* const name = parameters.contains("nlevels") ? "nlevels" : "levels";
        const auto levels = static_cast<uint32_t>(std::clamp<int64_t>(parameters.integer(name, 3, sink), 0, 31));
        parameters.ignore({"scheme"});
        const uint32_t done = subdivide_loop(levels, mesh);
        if (done < levels)
            sink.leave_out({parameters.location(), fmt::format("{} of {} levels of {} are left out", levels - done,
                                                               levels, parameters.what())});
        shape.exact.clear();
        for (const Vec3& p : mesh.positions) shape.exact.push_back(to_double(p));
    }
    return add_mesh(std::move(shape), is_subdivision);
}

ReadShape Shapes::bilinear_mesh(bool is_reversed, Parameters& parameters) {
    ShapeMesh shape = read_vertices(is_reversed, parameters);
    std::vector<uint32_t> indices = indices_of(parameters.numbers("indices", 4, context_.sink));
    if (indices.empty() && shape.mesh.positions.size() == 4) indices = {0, 1, 2, 3};
    if (indices.empty()) throw parameters.error(fmt::format("{} has no \"integer indices\"", parameters.what()));
    std::vector<BilinearCorners> patches;
    for (std::size_t i = 0; i + 3 < indices.size(); i += 4) {
        patches.push_back({indices[i], indices[i + 1], indices[i + 2], indices[i + 3]});
        for (const uint32_t corner : patches.back()) {
            if (corner < shape.mesh.positions.size()) continue;
            throw parameters.error(fmt::format("{} has an index out of range; there are {}, counted from 0",
                                               parameters.what(), counted(shape.mesh.positions.size(), "point")));
        }
    }
    parameters.leave_out({"emissionfilename"}, "the emission has no picture of its own", context_.sink);
    parameters.ignore({"faceIndices"});
    triangulate_patches(patches, shape.mesh);
    shape.exact.clear();
    for (const Vec3& p : shape.mesh.positions) shape.exact.push_back(to_double(p));
    return add_mesh(std::move(shape), true);
}

ReadShape Shapes::ply_mesh(bool is_reversed, Parameters& parameters) {
    const std::string name = parameters.text("filename", "", context_.sink);
    if (name.empty()) throw parameters.error("a plymesh has no \"string filename\"");
    parameters.leave_out({"displacement"}, "meshes are not displaced", context_.sink);
    parameters.ignore({"edgelength"});
    const auto path = context_.access.find(base_of(context_, parameters.location(), name), name, context_.sink);
    if (!path) throw parameters.error(fmt::format("there is no file {}", shortened(name)));
    const auto [known, is_new] = shared_.try_emplace(fmt::format("{} {}", is_reversed, path->string()), 0);
    if (!is_new) return {known->second, {}};
    ShapeMesh shape;
    shape.location = parameters.location();
    shape.is_reversed = is_reversed;
    shape.file = path->string();
    const ReadShape read = add_mesh(std::move(shape), false);
    known->second = read.mesh;
    return read;
}

ReadShape Shapes::quadric(const std::string& type, bool is_reversed, Parameters& parameters) {
    Sink& sink = context_.sink;
    const double radius = parameters.number("radius", 1, sink);
    if (!(radius > 0))
        throw parameters.error(fmt::format("the radius of {} is {}; expected above 0", parameters.what(), radius));
    const auto sweep = static_cast<float>(std::clamp(parameters.number("phimax", 360, sink), 0.0, 360.0)) * (kPi / 180);
    ShapeMesh shape;
    shape.location = parameters.location();
    shape.is_reversed = is_reversed;
    shape.is_quadric = true;
    DoubleTransform from_mesh = scale_by({radius, radius, radius});
    float first = 0, second = 0;
    if (type == "disk") {
        first = static_cast<float>(std::clamp(parameters.number("innerradius", 0, sink) / radius, 0.0, 0.999999));
        from_mesh.translation.z = parameters.number("height", 0, sink);
    } else {
        const bool is_sphere = type == "sphere";
        double low = parameters.number("zmin", is_sphere ? -radius : -1, sink),
               high = parameters.number("zmax", is_sphere ? radius : 1, sink);
        if (low > high) std::swap(low, high);
        if (is_sphere) low = std::clamp(low, -radius, radius), high = std::clamp(high, -radius, radius);
        if (!(low < high))
            throw parameters.error(fmt::format("{} has no height; expected zmin below zmax", parameters.what()));
        if (is_sphere) {
            first = static_cast<float>(low / radius), second = static_cast<float>(high / radius);
        } else { // its height is 1, so that all share one mesh
            from_mesh.row2.z = high - low;
            from_mesh.translation.z = low;
            second = 1;
        }
    }
    const auto [known, is_new] =
        shared_.try_emplace(fmt::format("{} {} {} {} {}", type, is_reversed, first, second, sweep), 0);
    if (is_new) {
        shape.mesh = type == "sphere" ? make_sphere(first, second, sweep)
                     : type == "disk" ? make_disk(first, sweep)
                                      : make_cylinder(first, second, sweep);
        known->second = add_mesh(std::move(shape), true).mesh;
    }
    return {known->second, from_mesh};
}

std::optional<ReadShape> Shapes::read(const std::string& type, bool is_reversed, Parameters& parameters) {
    if (type == "trianglemesh" || type == "loopsubdiv")
        return triangle_mesh(type == "loopsubdiv", is_reversed, parameters);
    if (type == "plymesh") return ply_mesh(is_reversed, parameters);
    if (type == "bilinearmesh") return bilinear_mesh(is_reversed, parameters);
    if (type == "sphere" || type == "disk" || type == "cylinder") return quadric(type, is_reversed, parameters);
    constexpr std::array<std::string_view, 8> kOthers = {"curve",       "cone",  "paraboloid",   "hyperboloid",
                                                         "heightfield", "nurbs", "heightfield2", "none"};
    const bool is_known = std::ranges::find(kOthers, type) != kOthers.end();
    context_.sink.leave_out({parameters.location(), fmt::format("shapes of the type {} are left out{}", shortened(type),
                                                                is_known ? "" : did_you_mean(type, kShapeTypes))});
    return std::nullopt;
}

void Shapes::read_ply_file(ShapeMesh& to, Sink& sink) const {
    ReadOptions options = context_.options;
    options.geometry_only = true; // pbrt takes neither colours nor textures from it
    const std::filesystem::path path = to.file;
    Scene scene = read_ply(path, context_.access, options, sink);
    if (scene.meshes.size() != 1) throw Error(ErrorCode::BadInput, FileLocation{to.file}, "the file has no mesh");
    to.mesh = std::move(scene.meshes.front());
    to.shape_from_mesh = translation_by(scene.origin_in_file);
}

void Shapes::finish() {
    finish_meshes(
        meshes_, [this](ShapeMesh& shape, Sink& sink) { read_ply_file(shape, sink); }, context_.sink);
}

} // namespace pertev::pbrt
