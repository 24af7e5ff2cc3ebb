#include "formats/obj/parse_obj.h"

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <deque>
#include <limits>
#include <optional>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "base/error.h"
#include "base/huge_pages.h"
#include "base/message_text.h"
#include "base/parallel_for.h"
#include "formats/files/parse_number.h"
#include "formats/mesh/move_positions.h"
#include "formats/mesh/triangulate_polygon.h"
#include "formats/mesh/vertex_colors.h"
#include "formats/obj/obj_pieces.h"
#include "formats/obj/obj_text.h"
#include "scene/position_bounds.h"
#include "scene/scene_origin.h"

namespace pertev {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

struct Face {
    uint32_t corner_count, line;
};

/// Faces of one object, group and material in one piece of the text.
struct RawGroup {
    ObjGroupKey key;
    uint32_t line = 0;              // line of the first face
    std::vector<ObjCorner> corners; // corners of all faces, one after the other
    std::vector<Face> faces;
};

Error fault_at(const std::string& file, uint32_t line, const std::string& what) {
    return Error(ErrorCode::BadInput, FileLocation{file, line}, what);
}

/// Parses one piece, and writes its vertices to their positions in arrays that have their final size.
class PieceParser {
public:
    /// Parses into `data`, and into `exact`, the positions in double, in the order of those of `data`.
    PieceParser(const ObjPiece& piece, char end_of_line, const std::string& file, ObjData& data,
                std::span<DoubleVec3> exact, const FoundMaterials* found_materials)
        : lines_(piece.text, end_of_line, piece.line), file_(file), before_(piece.counts), so_far_(piece.counts),
          data_(data), exact_(exact), found_materials_(found_materials), key_(piece.key) {}

    void run() {
        for (std::string_view line; lines_.next(line);) statement(line);
    }

    std::vector<Vec4> colors; // colours of its positions, as written; or empty
    std::vector<RawGroup> groups;
    std::vector<ObjMaterialFiles> material_files;
    std::optional<Remark> first_bad_face; // reason why its first face was left out
    CountedLines bad_faces, bad_numbers, short_faces, points_and_lines, free_form, unknown;

private:
    Error fault_here(const std::string& what) const { return fault_at(file_, lines_.number(), what); }

    void statement(std::string_view line) {
        const std::string_view key = take_word(line);
        if (key.empty() || key[0] == '#') return;
        if (key == "v") return vertex(line);
        if (key == "f" || key == "fo") return face(line);
        if (key == "vn") {
            const auto n = numbers<3>(line);
            data_.normals.at(so_far_.normals++) = {n[0], n[1], n[2]};
            return;
        }
        if (key == "vt") {
            const auto t = numbers<1>(line);
            data_.uvs.at(so_far_.uvs++) = {t[0], next_number(line).value_or(0)};
            return;
        }
        if (key == "usemtl" || key == "o" || key == "g") {
            current_ = nullptr;
            (key == "o" ? key_.object : key == "g" ? key_.group : key_.material) = rest_as_name(line);
            return;
        }
        if (key == "mtllib") {
            material_files.push_back({std::string(rest_as_name(line)), lines_.number()});
            if (found_materials_ != nullptr && material_files.size() == 1) (*found_materials_)(material_files.front());
            return;
        }
        if (key == "p" || key == "l") return points_and_lines.add(lines_.number());
        other(key);
    }

    void other(std::string_view key) {
        // Smoothing groups (files that want smooth normals contain them) and display hints change nothing.
        for (const char* harmless :
             {"s", "mg", "lod", "bevel", "c_interp", "d_interp", "usemap", "maplib", "shadow_obj", "trace_obj"}) {
            if (key == harmless) return;
        }
        for (const char* curved :
             {"vp",   "deg", "bmat", "step", "cstype", "curv",  "curv2", "surf", "parm", "trim", "hole",
              "scrv", "sp",  "end",  "con",  "ctech",  "stech", "bsp",   "bzp",  "cdc",  "res"}) {
            if (key == curved) return free_form.add(lines_.number());
        }
        unknown.add(lines_.number());
    }

    template <class Float = float>
    std::optional<Float> next_number(std::string_view& line) {
        skip_space(line);
        if (line.empty() || line[0] == '#') return std::nullopt;
        const std::optional<Float> value = parse_float<Float>(line);
        if (value && (line.empty() || is_obj_space(line[0]))) return value;
        bad_numbers.add(lines_.number());
        take_word(line);
        return Float(kNan);
    }

    template <class Float>
    Float wanted_number(std::string_view& line) {
        const std::optional<Float> number = next_number<Float>(line);
        if (!number) bad_numbers.add(lines_.number());
        return number.value_or(Float(kNan));
    }

    template <std::size_t count>
    std::array<float, count> numbers(std::string_view& line) {
        std::array<float, count> values;
        for (float& value : values) value = wanted_number<float>(line);
        return values;
    }

    /// Returns the float that is nearest to the decimals that `number` was read from, which `text` begins with.
    static float nearest_float(double number, std::string_view text) {
        // A number halfway between two floats may be the decimals rounded to there, and then be rounded the wrong way.
        const bool may_be_halfway = (std::bit_cast<uint64_t>(number) & 0x1fffffffu) == 0x10000000u;
        using Limits = std::numeric_limits<float>;
        const double size = std::abs(number);
        const bool is_plain = size == 0 || (size >= double(Limits::min()) && size <= double(Limits::max()));
        if (is_plain && !may_be_halfway) return static_cast<float>(number);
        skip_space(text);
        return parse_float(text).value_or(kNan);
    }

    void vertex(std::string_view line) {
        std::array<double, 3> exact;
        std::array<float, 3> rounded;
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const std::string_view text = line;
            exact[axis] = wanted_number<double>(line);
            rounded[axis] = nearest_float(exact[axis], text);
        }
        data_.positions.at(so_far_.positions) = {rounded[0], rounded[1], rounded[2]};
        exact_[so_far_.positions++] = {exact[0], exact[1], exact[2]};
        std::array<float, 3> rgb;
        std::size_t found = 0;
        while (found < 3) {
            const std::optional<float> value = next_number(line);
            if (!value) break;
            rgb[found++] = *value;
        }
        if (found == 3) { // one more alone is a weight for rational curves
            colors.resize(so_far_.positions - before_.positions - 1, kNoVertexColor);
            colors.push_back({rgb[0], rgb[1], rgb[2], 1});
        } else if (!colors.empty()) {
            colors.push_back(kNoVertexColor);
        }
    }

    /// Parses an index of v, vt or vn, of which 1 is the first and -1 the last so far.
    uint32_t index(std::string_view& text, std::size_t count_so_far, const char* of) {
        int64_t number = 0;
        const char* end = text.data() + text.size();
        const auto [after, ec] = std::from_chars(text.data(), end, number);
        if (ec == std::errc::invalid_argument) {
            throw fault_here("a face's corner is v, v/vt, v//vn or v/vt/vn, all whole numbers");
        }
        const int64_t zero_based = number < 0 ? static_cast<int64_t>(count_so_far) + number : number - 1;
        // An index may lead to what stands further down, so the upper end is checked when all is read.
        if (ec != std::errc{} || number == 0 || zero_based < 0 || zero_based >= int64_t(kNoIndex)) {
            throw fault_here(fmt::format("{} index {} is out of range; there are {} above, counted from 1", of,
                                         std::string_view(text.data(), static_cast<std::size_t>(after - text.data())),
                                         count_so_far));
        }
        text.remove_prefix(static_cast<std::size_t>(after - text.data()));
        return static_cast<uint32_t>(zero_based);
    }

    ObjCorner corner(std::string_view word) {
        ObjCorner corner = {kNoIndex, kNoIndex, kNoIndex};
        corner.position = index(word, so_far_.positions, "vertex");
        if (word.starts_with('/')) {
            word.remove_prefix(1);
            if (!word.empty() && word[0] != '/') corner.uv = index(word, so_far_.uvs, "texture coordinate");
            if (word.starts_with('/')) {
                word.remove_prefix(1);
                if (!word.empty()) corner.normal = index(word, so_far_.normals, "normal");
            }
        }
        if (!word.empty()) {
            throw fault_here("a face's corner is v, v/vt, v//vn or v/vt/vn, all whole numbers");
        }
        return corner;
    }

    void face(std::string_view line) {
        if (current_ == nullptr) {
            const auto [found, is_new] = numbers_.try_emplace(key_, groups.size());
            if (is_new) groups.push_back({key_, lines_.number(), {}, {}});
            current_ = &groups[found->second];
        }
        const std::size_t before = current_->corners.size();
        try {
            for (std::string_view word = take_word(line); !word.empty() && word[0] != '#'; word = take_word(line)) {
                current_->corners.push_back(corner(word));
            }
        } catch (const Error& error) {
            current_->corners.resize(before);
            if (bad_faces.times == 0) first_bad_face = error.remark();
            bad_faces.add(lines_.number());
            return;
        }
        const std::size_t count = current_->corners.size() - before;
        if (count < 3) {
            current_->corners.resize(before);
            short_faces.add(lines_.number());
            return;
        }
        current_->faces.push_back({static_cast<uint32_t>(count), lines_.number()});
    }

    ObjLines lines_;
    const std::string& file_;
    const ObjCounts before_;
    ObjCounts so_far_;
    ObjData& data_;
    std::span<DoubleVec3> exact_;
    const FoundMaterials* found_materials_; // null: not requested
    ObjGroupNumbers numbers_;
    ObjGroupKey key_;
    RawGroup* current_ = nullptr; // group of key_; null until a face needs it
};

class ObjParser {
public:
    ObjParser(std::string_view text, const std::string& file, Sink& sink, std::size_t piece_bytes)
        : file_(file), sink_(sink), end_of_line_(ObjLines::end_of_line_of(text)),
          pieces_(cut_into_obj_pieces(text, end_of_line_, piece_bytes)) {}

    ObjData run(const FoundMaterials& found_materials) {
        parse_pieces(found_materials);
        move_to_origin();
        if (!join_groups(false)) {
            sink_.note(
                {FileLocation{file_},
                 fmt::format("more than {} objects and groups; faces are grouped by material only", kMaxObjGroups)});
            join_groups(true);
        }
        join_colors();
        for (PieceParser& parser : parsers_)
            for (ObjMaterialFiles& files : parser.material_files) data_.material_files.push_back(std::move(files));
        data_.groups.resize(groups_.size());
        std::vector<CountedLines> without_uv(groups_.size()), without_vertex(groups_.size());
        parallel_for(groups_.size(), 1,
                     [&](uint64_t i) { finish(groups_[i], data_.groups[i], without_uv[i], without_vertex[i]); });
        std::erase_if(data_.groups, [](const ObjGroup& group) { return group.corners.empty(); });
        CountedLines missing;
        for (const CountedLines& of_group : without_uv) missing.add(of_group);
        leave_out_bad_faces();
        CountedLines no_vertex;
        for (const CountedLines& of_group : without_vertex) no_vertex.add(of_group);
        leave_out(no_vertex, "face", "with a missing vertex");
        leave_out(all_of(&PieceParser::short_faces), "face", "with fewer than three corners");
        leave_out(all_of(&PieceParser::points_and_lines), "statement", "of points or lines");
        leave_out(all_of(&PieceParser::free_form), "statement", "of curves or free-form surfaces");
        leave_out(all_of(&PieceParser::unknown), "line", "of unknown kinds");
        warn(missing, "face corner", "with a missing texture coordinate or normal, which is ignored");
        warn(all_of(&PieceParser::bad_numbers), "line", "with a missing or unreadable number");
        return std::move(data_);
    }

private:
    using Parts = std::vector<RawGroup*>; // parts of one group, in the order of the text

    CountedLines all_of(CountedLines PieceParser::*what) const {
        CountedLines all;
        for (const PieceParser& parser : parsers_) all.add(parser.*what);
        return all;
    }

    void leave_out_bad_faces() const {
        const CountedLines bad = all_of(&PieceParser::bad_faces);
        if (bad.times == 0) return;
        const auto first =
            std::ranges::find_if(parsers_, [](const PieceParser& parser) { return parser.bad_faces.times > 0; });
        sink_.leave_out(first->first_bad_face->and_then(
            fmt::format("; {} {} left out", counted(bad.times, "such face"), is_or_are(bad.times))));
    }

    Remark remark_on(const CountedLines& what, const char* thing, const char* text) const {
        return {FileLocation{file_, what.first_line}, fmt::format("{} {}", counted(what.times, thing), text)};
    }

    void leave_out(const CountedLines& what, const char* thing, const char* text) const {
        if (what.times == 0) return;
        sink_.leave_out(remark_on(what, thing, text).and_then(fmt::format(" {} left out", is_or_are(what.times))));
    }

    void warn(const CountedLines& what, const char* thing, const char* text) const {
        if (what.times > 0) sink_.warn(remark_on(what, thing, text));
    }

    void parse_pieces(const FoundMaterials& found_materials) {
        const ObjCounts all = count_before(pieces_, end_of_line_);
        if (std::max({all.positions, all.uvs, all.normals}) >= kNoIndex) {
            throw Error(ErrorCode::OverLimit, FileLocation{file_}, "more than 2^32 - 1 vertices");
        }
        data_.positions = array_on_huge_pages<Vec3>(all.positions); // pieces write to disjoint ranges
        exact_ = array_on_huge_pages<DoubleVec3>(all.positions);
        data_.uvs = array_on_huge_pages<Vec2>(all.uvs);
        data_.normals = array_on_huge_pages<Vec3>(all.normals);
        for (std::size_t i = 0; i < pieces_.size(); ++i)
            parsers_.emplace_back(pieces_[i], end_of_line_, file_, data_, exact_,
                                  i == 0 && found_materials ? &found_materials : nullptr);
        parallel_for(parsers_.size(), 1, [&](uint64_t i) {
            sink_.check();
            parsers_[i].run();
        });
    }

    /// Bounds of the positions that a sample of face corners refers to.
    Bounds3 bounds_of_faces(std::size_t apart = 1) const {
        std::vector<Bounds3> boxes(parsers_.size());
        const std::span<const Vec3> positions = data_.positions;
        parallel_for(parsers_.size(), 1, [&](uint64_t i) {
            Bounds3 box; // a local, so that it stays in registers
            for (const RawGroup& group : parsers_[i].groups) {
                for (std::size_t k = 0; k < group.corners.size(); k += apart) {
                    const uint32_t position = group.corners[k].position;
                    if (position < positions.size()) box.extend(positions[position]);
                }
            }
            boxes[i] = box;
        });
        Bounds3 box;
        for (const Bounds3& of_piece : boxes) box.extend(of_piece);
        return box;
    }

    /// Subtracts the origin in double if the faces are away from 0.
    void move_to_origin() {
        const std::vector<DoubleVec3> exact = std::exchange(exact_, {}); // not needed afterwards
        if (surely_stays(bounds_of_faces(kCornersApart))) return;
        data_.box = double_box_of(bounds_of_faces());
        if (origin_for(data_.box) == DoubleVec3{0, 0, 0}) return;
        data_.box = move_positions(data_.box, exact, data_.positions, [&] { return bounds_of_faces(); });
    }

    /// Joins the parts of each group. Returns false if there are more than kMaxObjGroups.
    bool join_groups(bool by_material_alone) {
        ObjGroupNumbers numbers;
        groups_.clear();
        for (PieceParser& parser : parsers_) {
            for (RawGroup& group : parser.groups) {
                if (by_material_alone) group.key.object = group.key.group = {};
                const auto [found, is_new] = numbers.try_emplace(group.key, groups_.size());
                if (is_new && groups_.size() == kMaxObjGroups && !by_material_alone) return false;
                if (is_new) groups_.emplace_back();
                groups_[found->second].push_back(&group);
            }
        }
        return true;
    }

    void join_colors() {
        const auto has_colors = [](const PieceParser& parser) { return !parser.colors.empty(); };
        if (std::ranges::none_of(parsers_, has_colors)) return;
        data_.colors.resize(data_.positions.size(), kNoVertexColor);
        for (std::size_t i = 0; i < pieces_.size(); ++i) {
            const auto first = static_cast<std::ptrdiff_t>(pieces_[i].counts.positions);
            std::ranges::copy(parsers_[i].colors, data_.colors.begin() + first);
        }
        decode_vertex_colors(data_.colors, file_, sink_);
    }

    /// Checks a group's indices and cuts its faces into triangles.
    void finish(const Parts& parts, ObjGroup& group, CountedLines& without, CountedLines& without_vertex) const {
        group.name = name_of(parts.front()->key);
        group.material = parts.front()->key.material;
        group.line = parts.front()->line;
        std::size_t triangles = 0;
        for (const RawGroup* part : parts)
            for (const Face& face : part->faces) triangles += face.corner_count - 2;
        reserve_on_huge_pages(group.corners, 3 * triangles);
        for (RawGroup* part : parts) {
            cut_faces(*part, group, without, without_vertex);
            *part = {};
        }
    }

    void cut_faces(RawGroup& raw, ObjGroup& group, CountedLines& without, CountedLines& without_vertex) const {
        std::vector<Vec3> polygon;
        std::vector<uint32_t> cut;
        ObjCorner* corners = raw.corners.data();
        for (const Face& face : raw.faces) {
            sink_.check_at(static_cast<uint64_t>(&face - raw.faces.data()));
            for (uint32_t i = 0; i < face.corner_count; ++i) check(corners[i], face.line, without);
            const bool has_all = std::all_of(corners, corners + face.corner_count, [&](const ObjCorner& corner) {
                return corner.position < data_.positions.size();
            });
            if (!has_all) {
                without_vertex.add(face.line);
            } else if (face.corner_count == 3) {
                group.corners.insert(group.corners.end(), corners, corners + 3);
            } else {
                polygon.clear();
                cut.clear();
                for (uint32_t i = 0; i < face.corner_count; ++i)
                    polygon.push_back(data_.positions[corners[i].position]);
                triangulate_polygon(polygon, cut);
                for (const uint32_t i : cut) group.corners.push_back(corners[i]);
            }
            corners += face.corner_count;
        }
    }

    void check(ObjCorner& corner, uint32_t line, CountedLines& without) const {
        if (corner.uv != kNoIndex && corner.uv >= data_.uvs.size()) {
            without.add(line);
            corner.uv = kNoIndex;
        }
        if (corner.normal != kNoIndex && corner.normal >= data_.normals.size()) {
            without.add(line);
            corner.normal = kNoIndex;
        }
    }

    const std::string& file_;
    Sink& sink_;
    const char end_of_line_;
    std::vector<ObjPiece> pieces_;
    std::deque<PieceParser> parsers_; // parsers of the pieces
    ObjData data_;
    std::vector<DoubleVec3> exact_; // positions as in the text
    std::vector<Parts> groups_;     // in the order of first use
};

} // namespace

ObjData parse_obj(std::span<const std::byte> bytes, const std::string& file, Sink& sink,
                  const FoundMaterials& found_materials, std::size_t piece_bytes) {
    return ObjParser(text_of(bytes), file, sink, piece_bytes).run(found_materials);
}

} // namespace pertev
