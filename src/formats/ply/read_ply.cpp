#include "formats/ply/read_ply.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>

#include <fmt/format.h>

#include "base/error.h"
#include "base/limits.h"
#include "base/message_text.h"
#include "formats/files/gunzip.h"
#include "formats/files/load_textures.h"
#include "formats/mesh/move_positions.h"
#include "formats/mesh/triangulate_polygon.h"
#include "formats/mesh/vertex_colors.h"
#include "formats/ply/ply_body.h"
#include "formats/ply/ply_header.h"
#include "formats/ply/ply_slots.h"
#include "formats/ply/ply_textures.h"
#include "image/srgb.h"
#include "scene/position_bounds.h"
#include "scene/scene_origin.h"

namespace fs = std::filesystem;

namespace pertev {
namespace {

bool is_float(PlyType type) { return type == PlyType::Float32 || type == PlyType::Float64; }

/// Converts a colour channel to [0, 1], linear; one of a floating-point type is unchanged.
float colour(double value, PlyType type, bool is_alpha) {
    if (is_float(type)) return static_cast<float>(value);
    if (std::isnan(value)) return 1; // could not be read
    const double full = type == PlyType::UInt16 ? 65535.0 : 255.0;
    const float encoded = static_cast<float>(value / full);
    return is_alpha ? encoded : srgb_decode(encoded);
}

class Reader {
public:
    Reader(std::span<const std::byte> bytes, const PlyHeader& header, const std::string& file, Sink& sink)
        : body_(bytes, header, file), header_(header), file_(file), sink_(sink) {
        for (const PlyElement& element : header.elements) {
            if (element.name == "vertex") vertex_count_ = std::min<uint64_t>(element.count, 0xffffffffu);
        }
    }

    /// Box of the vertices that faces use, in the coordinates of the file. Its origin_for() has been subtracted from
    /// the mesh.
    const DoubleBounds3& box() const { return box_; }

    /// Reads the file's mesh. Its faces are described by sizes() and of_faces().
    Mesh run() {
        if (std::none_of(header_.elements.begin(), header_.elements.end(), is_surface)) {
            throw Error(ErrorCode::BadInput, FileLocation{file_},
                        "the file has no faces; expected an element face with a list vertex_indices");
        }
        for (const PlyElement& element : header_.elements) {
            body_.set_location(element.name, 0);
            if (element.properties.empty() && element.name != "vertex") continue; // takes no bytes, whatever its count
            std::size_t least = 0;
            for (const PlyProperty& p : element.properties) least += body_.min_size(p.is_list ? p.count_type : p.type);
            try {
                const bool may_be_cut_off = element.name == "face" || element.name == "tristrips";
                if (!may_be_cut_off) body_.expect(element.count, std::max<std::size_t>(least, 1), "elements");
                if (element.name == "vertex") {
                    vertices(element);
                } else {
                    lists(element);
                }
            } catch (const Error& error) {
                const bool has_faces = !mesh_.positions.empty() && !sizes_.empty();
                if (error.code() != ErrorCode::BadInput || element.name == "vertex" || !has_faces) throw;
                if (!of_faces_.textures.empty())
                    sizes_.resize(of_faces_.textures.size()); // the last may lack its texture
                corners_.resize(std::accumulate(sizes_.begin(), sizes_.end(), std::size_t(0)));
                sink_.leave_out(error.remark().and_then("; the rest is left out"));
                break;
            }
        }
        move_to_origin();
        if (has_float_colors_) decode_vertex_colors(mesh_.colors, file_, sink_);
        if (!of_faces_.textures.empty() && of_faces_.textures.size() != sizes_.size()) {
            sink_.leave_out({FileLocation{file_}, "textures of faces in a file with triangle strips are left out"});
            of_faces_ = {};
        }
        if (!of_faces_.uvs.empty()) split_vertices(of_faces_.uvs, corners_, mesh_);
        triangulate();
        warn_of_face_properties();
        body_.warn(sink_);
        if (bad_indices_ > 0) {
            sink_.leave_out(first_bad_index_->and_then(fmt::format(
                "; what {} left out",
                bad_indices_ == 1 ? "has that corner is" : fmt::format("has such a corner, of {}, is", bad_indices_))));
        }
        if (bad_textures_ > 0) {
            sink_.leave_out(
                {FileLocation{file_}, fmt::format("{} with a texture that the header does not list {} without it",
                                                  counted(bad_textures_, "face"), is_or_are(bad_textures_))});
        }
        if (strays_ > 0) {
            sink_.leave_out({FileLocation{file_}, fmt::format("{} with fewer than three corners {} left out",
                                                              counted(strays_, "face"), is_or_are(strays_))});
        }
        return std::move(mesh_);
    }
    const std::vector<uint32_t>& sizes() const { return sizes_; }
    const PlyFaceTextures& of_faces() const { return of_faces_; }

private:
    static bool is_face_uv(const PlyProperty& p) {
        return p.is_list && (p.name == "texcoord" || p.name == "texture_uv" || p.name == "texcoords");
    }
    static bool is_indices(const PlyProperty& p) {
        return p.is_list && (p.name == "vertex_indices" || p.name == "vertex_index");
    }
    static bool is_surface(const PlyElement& element) {
        return (element.name == "face" || element.name == "tristrips") && element.count > 0 &&
               std::any_of(element.properties.begin(), element.properties.end(), is_indices);
    }

    void warn_of_face_properties() const {
        for (const PlyElement& element : header_.elements) {
            if (element.name != "face" || element.count == 0) continue;
            bool has_colour = false, has_uv = false;
            for (const PlyProperty& p : element.properties) {
                const std::size_t slot = p.is_list ? kSlots : ply_slot_of(p.name);
                has_colour |= slot == kRed || slot == kGreen || slot == kBlue;
                has_uv |= is_face_uv(p) && header_.textures.empty();
            }
            if (has_colour)
                sink_.leave_out(
                    {FileLocation{file_}, "colours of faces are left out; only those of vertices are read"});
            if (has_uv)
                sink_.leave_out(
                    {FileLocation{file_},
                     "texture coordinates of faces are left out, because no comment TextureFile names a texture"});
        }
    }

    using VertexValues = std::array<double, kSlots + 1>; // by slot

    static void read_values(PlyBody& body, const PlyElement& element, const std::vector<std::size_t>& slots,
                            VertexValues& values) {
        for (std::size_t k = 0; k < slots.size(); ++k) {
            if (body.is_line_bad()) {
                values.fill(std::numeric_limits<double>::quiet_NaN());
                return;
            }
            if (slots[k] == kSlots) {
                body.skip(element.properties[k]);
            } else {
                values[slots[k]] = body.value(element.properties[k].type);
            }
        }
    }

    void vertices(const PlyElement& element) {
        if (element.count > std::numeric_limits<uint32_t>::max()) {
            throw Error(ErrorCode::OverLimit, FileLocation{file_}, "more than 2^32 - 1 vertices");
        }
        std::vector<std::size_t> slots;
        std::array<bool, kSlots + 1> has = {};
        std::array<PlyType, kSlots + 1> types = {};
        for (const PlyProperty& p : element.properties) {
            // The first of a name counts: `s` and `u` may both be there.
            std::size_t slot = p.is_list ? kSlots : ply_slot_of(p.name);
            if (has[slot]) slot = kSlots;
            slots.push_back(slot);
            has[slot] = true;
            types[slot] = p.type;
        }
        if (!has[kX] || !has[kY] || !has[kZ]) throw body_.fault("a vertex needs the properties x, y and z");
        const bool has_normal = has[kNormalX] && has[kNormalY] && has[kNormalZ];
        const bool has_colour = has[kRed] && has[kGreen] && has[kBlue], has_uv = has[kU] && has[kV];
        const auto count = static_cast<std::size_t>(element.count);
        mesh_.positions.resize(count);
        // The file's positions may be more precise than floats.
        const bool is_text = header_.format == PlyFormat::Ascii;
        const auto is_float_there = [&](PlySlot slot) { return types[slot] == PlyType::Float32; };
        if (is_text || !(is_float_there(kX) && is_float_there(kY) && is_float_there(kZ))) exact_.resize(count);
        if (has_normal) mesh_.normals.resize(count);
        if (has_colour) mesh_.colors.resize(count);
        if (has_uv) mesh_.uv[0].resize(count);
        has_float_colors_ = has_colour && is_float(types[kRed]) && is_float(types[kGreen]) && is_float(types[kBlue]);

        VertexValues values = {};
        values[kAlpha] = 1;
        const auto number = [&](PlySlot slot) { return static_cast<float>(values[slot]); };
        const auto channel = [&](PlySlot slot) { return colour(values[slot], types[slot], slot == kAlpha); };
        for (std::size_t i = 0; i < count; ++i) {
            sink_.check_at(i);
            body_.set_number(i);
            read_values(body_, element, slots, values);
            mesh_.positions[i] = {number(kX), number(kY), number(kZ)};
            if (!exact_.empty()) exact_[i] = {values[kX], values[kY], values[kZ]};
            if (has_normal) mesh_.normals[i] = {number(kNormalX), number(kNormalY), number(kNormalZ)};
            if (has_colour) {
                mesh_.colors[i] = {channel(kRed), channel(kGreen), channel(kBlue),
                                   has[kAlpha] ? channel(kAlpha) : 1.0f};
            }
            if (has_uv) mesh_.uv[0][i] = {number(kU), 1 - number(kV)};
            body_.end_element();
        }
    }

    /// Reads faces and triangle strips; other elements are skipped.
    void lists(const PlyElement& element) {
        const bool is_face = element.name == "face", is_strip = element.name == "tristrips";
        const bool has_textures = is_face && !header_.textures.empty();
        const bool has_uv = has_textures && std::ranges::any_of(element.properties, is_face_uv);
        const bool has_numbers = has_textures && std::ranges::any_of(element.properties, is_texture_number);
        for (uint64_t i = 0; i < element.count; ++i) {
            sink_.check_at(i);
            body_.set_number(i);
            bool taken = false;
            uint64_t corners = 0;
            face_uvs_.clear();
            double texture = 0;
            for (const PlyProperty& p : element.properties) {
                if (body_.is_line_bad()) break;
                if ((is_face || is_strip) && !taken && is_indices(p)) {
                    taken = true;
                    corners = is_face ? face(p) : strip(p);
                } else if (has_uv && is_face_uv(p)) {
                    face_uv(p);
                } else if (has_numbers && is_texture_number(p)) {
                    texture = body_.value(p.type);
                } else {
                    body_.skip(p);
                }
            }
            if (body_.is_line_bad()) corners = drop_face(corners);
            body_.end_element();
            if (corners >= 3 && has_uv) add_face_uvs(corners, texture);
            if (corners >= 3 && (has_uv || has_numbers)) of_faces_.textures.push_back(texture_of(texture));
        }
    }

    /// Removes the last face, which has `corners` corners. Returns 0.
    uint64_t drop_face(uint64_t corners) {
        if (corners == 0) return 0;
        corners_.resize(corners_.size() - corners);
        sizes_.pop_back();
        return 0;
    }

    static bool is_texture_number(const PlyProperty& p) { return !p.is_list && p.name == "texnumber"; }

    void face_uv(const PlyProperty& property) {
        const uint64_t count = body_.list_count(property);
        for (uint64_t i = 0; i < count; ++i) face_uvs_.push_back(static_cast<float>(body_.value(property.type)));
    }

    /// Adds the texture coordinates of a face. One without a pair for each of its corners has no texture.
    void add_face_uvs(uint64_t corners, double& texture) {
        const bool is_whole = face_uvs_.size() == 2 * corners;
        if (!is_whole) texture = kNoPlyTexture;
        for (std::size_t k = 0; k < corners; ++k) {
            of_faces_.uvs.push_back(is_whole ? Vec2{face_uvs_[2 * k], 1 - face_uvs_[2 * k + 1]} : Vec2{});
        }
    }

    int32_t texture_of(double number) {
        if (number == kNoPlyTexture) return kNoPlyTexture;
        for (std::size_t i = 0; i < header_.textures.size(); ++i) {
            if (number == static_cast<double>(i)) return static_cast<int32_t>(i);
        }
        ++bad_textures_;
        return kNoPlyTexture;
    }

    /// Returns a value as the index of a vertex; nothing, which counts as a fault, if it is out of range.
    std::optional<uint32_t> vertex_of(double value) {
        if (value >= 0 && value < static_cast<double>(vertex_count_) && value == static_cast<uint32_t>(value)) {
            return static_cast<uint32_t>(value);
        }
        if (std::isnan(value)) return std::nullopt; // the reader has warned
        if (bad_indices_++ == 0) {
            first_bad_index_ =
                body_
                    .fault(fmt::format("vertex index {} is out of range; there are {} vertices, counted from 0", value,
                                       vertex_count_))
                    .remark();
        }
        return std::nullopt;
    }

    /// Reads a face. Returns its number of corners; 0 if it is left out.
    uint64_t face(const PlyProperty& property) {
        const uint64_t count = body_.list_count(property);
        if (count < 3 && !body_.is_line_bad()) ++strays_;
        const std::size_t before = corners_.size();
        for (uint64_t i = 0; i < count; ++i) {
            const std::optional<uint32_t> corner = vertex_of(body_.value(property.type));
            if (corner && count >= 3) corners_.push_back(*corner);
        }
        if (count >= 3 && corners_.size() - before == count) {
            sizes_.push_back(static_cast<uint32_t>(count));
        } else {
            corners_.resize(before);
        }
        return corners_.size() - before;
    }

    /// Reads triangle strips. Returns 0, because strips have no textures.
    uint64_t strip(const PlyProperty& property) {
        const uint64_t count = body_.list_count(property);
        uint32_t before[2] = {};
        uint64_t length = 0; // since the strip began; -1 begins a new one
        for (uint64_t i = 0; i < count; ++i) {
            const double value = body_.value(property.type);
            if (value == -1) {
                length = 0;
                continue;
            }
            const std::optional<uint32_t> vertex = vertex_of(value);
            if (!vertex) {
                length = 0;
                continue;
            }
            const uint32_t corner = *vertex;
            if (length >= 2) {
                const bool is_odd = length % 2 != 0;
                corners_.insert(corners_.end(), {before[is_odd ? 1 : 0], before[is_odd ? 0 : 1], corner});
                sizes_.push_back(3);
            }
            before[0] = before[1];
            before[1] = corner;
            ++length;
        }
        return 0;
    }

    /// Subtracts the origin in double if the faces are away from 0.
    void move_to_origin() {
        Bounds3 sample;
        for (std::size_t i = 0; i < corners_.size(); i += kCornersApart) sample.extend(mesh_.positions[corners_[i]]);
        if (surely_stays(sample)) return;
        box_ = double_box_of(bounds_of(mesh_.positions, corners_));
        if (origin_for(box_) == DoubleVec3{0, 0, 0}) return;
        if (exact_.empty()) {
            for (const Vec3& p : mesh_.positions) exact_.push_back(to_double(p));
        }
        box_ = move_positions(box_, exact_, mesh_.positions, [&] { return bounds_of(mesh_.positions, corners_); });
    }

    void triangulate() {
        std::size_t triangles = 0;
        for (const uint32_t size : sizes_) triangles += size - 2;
        if (triangles > kMaxTrianglesPerMesh) {
            throw Error(ErrorCode::OverLimit, FileLocation{file_},
                        fmt::format("{} triangles; a mesh has at most {}", triangles, kMaxTrianglesPerMesh));
        }
        if (triangles == sizes_.size()) {
            mesh_.indices = std::move(corners_);
            return;
        }
        mesh_.indices.reserve(3 * triangles);
        std::vector<Vec3> polygon;
        std::vector<uint32_t> cut;
        const uint32_t* corners = corners_.data();
        for (const uint32_t size : sizes_) {
            sink_.check_at(static_cast<uint64_t>(&size - sizes_.data()));
            polygon.clear();
            cut.clear();
            for (uint32_t i = 0; i < size; ++i) polygon.push_back(mesh_.positions[corners[i]]);
            triangulate_polygon(polygon, cut);
            for (const uint32_t i : cut) mesh_.indices.push_back(corners[i]);
            corners += size;
        }
    }

    PlyBody body_;
    const PlyHeader& header_;
    const std::string& file_;
    Sink& sink_;
    uint64_t vertex_count_ = 0; // declared count, because faces may precede the vertices
    Mesh mesh_;
    std::vector<DoubleVec3> exact_; // positions, if they are not floats in the file
    DoubleBounds3 box_;
    std::vector<uint32_t> corners_, sizes_; // corners of the faces, one after the other, and their numbers per face
    PlyFaceTextures of_faces_;
    std::vector<float> face_uvs_; // texture coordinates of the current face
    bool has_float_colors_ = false;
    uint64_t strays_ = 0, bad_indices_ = 0, bad_textures_ = 0;
    std::optional<Remark> first_bad_index_;
};

} // namespace

Scene read_ply(const fs::path& path, const FileAccess& access, const ReadOptions& options, Sink& sink) {
    const std::string file = path.string();
    const std::vector<std::byte> bytes = read_unzipped(path).bytes;
    PlyHeader header = parse_ply_header(bytes, file);
    for (const Remark& repair : header.repairs) sink.warn(repair);
    if (options.geometry_only) header.textures.clear();
    Reader reader(bytes, header, file, sink);
    Mesh mesh = reader.run();
    mesh.name = path.stem().string();
    if (options.geometry_only && !options.vertex_colors) mesh.colors.clear();
    TextureLoader loader(access, sink);
    loader.shrink_to(options.max_texture_size);
    Scene scene = make_ply_scene(std::move(mesh), reader.sizes(), reader.of_faces(), header, file, loader, sink);
    set_origin(reader.box(), scene);
    return scene;
}

} // namespace pertev
