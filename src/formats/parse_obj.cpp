#include "formats/parse_obj.h"

#include <charconv>
#include <limits>
#include <optional>
#include <string_view>
#include <unordered_map>

#include <fmt/format.h>

#include "base/error.h"
#include "base/message_text.h"
#include "base/parallel_for.h"
#include "formats/obj_text.h"
#include "formats/parse_number.h"
#include "formats/triangulate_polygon.h"
#include "image/srgb.h"

namespace pertev {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

struct Face {
    uint32_t corner_count, line;
};

struct RawGroup {
    std::string material;
    uint32_t line = 0;              // of the first face
    std::vector<ObjCorner> corners; // of all faces, one after the other
    std::vector<Face> faces;
};

class ObjParser {
public:
    ObjParser(std::string_view text, const std::string& file, Messages& messages)
        : lines_(text), file_(file), messages_(messages) {}

    ObjData run() {
        std::string_view line;
        while (lines_.next(line)) statement(line);
        check_counts();
        data_.groups.resize(groups_.size());
        std::vector<CountedLines> without_uv(groups_.size());
        parallel_for(groups_.size(), 1, [&](uint64_t i) { finish(groups_[i], data_.groups[i], without_uv[i]); });
        std::erase_if(data_.groups, [](const ObjGroup& group) { return group.corners.empty(); });
        CountedLines missing;
        for (const CountedLines& of_group : without_uv) {
            if (of_group.times == 0) continue;
            missing = {missing.times + of_group.times,
                       missing.times == 0 ? of_group.first_line : std::min(missing.first_line, of_group.first_line)};
        }
        say(missing, "face corner", "with a texture coordinate or normal that is not in the file: without it");
        say(bad_numbers_, "line", "with a number missing or not readable");
        say(short_faces_, "face", "of fewer than three corners: left out");
        say(points_and_lines_, "statement", "of points or lines: left out");
        say(free_form_, "statement", "of curves or free-form surfaces: left out");
        say(unknown_, "line", "not understood: left out");
        return std::move(data_);
    }

private:
    Error fault(uint32_t line, const std::string& what) const {
        return Error(ErrorCode::BadInput, fmt::format("{}:{}: {}", file_, line, what));
    }

    void say(const CountedLines& what, const char* thing, const char* text) const {
        if (what.times == 0) return;
        messages_.warn(fmt::format("{}:{}: {} {}", file_, what.first_line, counted(what.times, thing), text));
    }

    void statement(std::string_view line) {
        const std::string_view key = take_word(line);
        if (key.empty() || key[0] == '#') return;
        if (key == "v") return vertex(line);
        if (key == "f" || key == "fo") return face(line);
        if (key == "vn") {
            const auto n = numbers<3>(line);
            data_.normals.push_back({n[0], n[1], n[2]});
            return;
        }
        if (key == "vt") {
            const auto t = numbers<1>(line);
            data_.uvs.push_back({t[0], next_number(line).value_or(0)});
            return;
        }
        if (key == "usemtl") {
            current_ = nullptr;
            material_ = rest_as_name(line);
            return;
        }
        if (key == "mtllib") {
            data_.material_files.push_back({std::string(rest_as_name(line)), lines_.number()});
            return;
        }
        if (key == "p" || key == "l") return points_and_lines_.add(lines_.number());
        other(key);
    }

    void other(std::string_view key) {
        // Grouping, smoothing groups (files that want smooth normals give them) and display hints change nothing.
        for (const char* harmless : {"g", "o", "s", "mg", "lod", "bevel", "c_interp", "d_interp", "usemap", "maplib",
                                     "shadow_obj", "trace_obj"}) {
            if (key == harmless) return;
        }
        for (const char* curved :
             {"vp",   "deg", "bmat", "step", "cstype", "curv",  "curv2", "surf", "parm", "trim", "hole",
              "scrv", "sp",  "end",  "con",  "ctech",  "stech", "bsp",   "bzp",  "cdc",  "res"}) {
            if (key == curved) return free_form_.add(lines_.number());
        }
        unknown_.add(lines_.number());
    }

    std::optional<float> next_number(std::string_view& line) {
        skip_space(line);
        if (line.empty() || line[0] == '#') return std::nullopt;
        const std::optional<float> value = parse_float(line);
        if (value && (line.empty() || is_obj_space(line[0]))) return value;
        bad_numbers_.add(lines_.number());
        take_word(line);
        return kNan;
    }

    template <std::size_t count>
    std::array<float, count> numbers(std::string_view& line) {
        std::array<float, count> values;
        for (float& value : values) {
            const std::optional<float> number = next_number(line);
            if (!number) bad_numbers_.add(lines_.number());
            value = number.value_or(kNan);
        }
        return values;
    }

    void vertex(std::string_view line) {
        const auto p = numbers<3>(line);
        data_.positions.push_back({p[0], p[1], p[2]});
        std::array<float, 3> rgb;
        std::size_t found = 0;
        while (found < 3) {
            const std::optional<float> value = next_number(line);
            if (!value) break;
            rgb[found++] = *value;
        }
        const Vec4 white = {1, 1, 1, 1};
        if (found == 3) { // one more alone is a weight for rational curves
            data_.colors.resize(data_.positions.size() - 1, white);
            data_.colors.push_back({srgb_decode(rgb[0]), srgb_decode(rgb[1]), srgb_decode(rgb[2]), 1});
        } else if (!data_.colors.empty()) {
            data_.colors.push_back(white);
        }
    }

    /// One of v, vt, vn: 1 is the first, -1 the last so far.
    uint32_t index(std::string_view& text, std::size_t count_so_far, const char* of) {
        int64_t number = 0;
        const char* end = text.data() + text.size();
        const auto [after, ec] = std::from_chars(text.data(), end, number);
        if (ec == std::errc::invalid_argument) {
            throw fault(lines_.number(), "a face's corner is v, v/vt, v//vn or v/vt/vn, all whole numbers");
        }
        const int64_t zero_based = number < 0 ? static_cast<int64_t>(count_so_far) + number : number - 1;
        // An index may lead to what stands further down, so the upper end is checked when all is read.
        if (ec != std::errc{} || number == 0 || zero_based < 0 || zero_based >= int64_t(kNoIndex)) {
            throw fault(lines_.number(),
                        fmt::format("{} index {} is out of range; {} stand above, the first has index 1", of,
                                    std::string_view(text.data(), static_cast<std::size_t>(after - text.data())),
                                    count_so_far));
        }
        text.remove_prefix(static_cast<std::size_t>(after - text.data()));
        return static_cast<uint32_t>(zero_based);
    }

    ObjCorner corner(std::string_view word) {
        ObjCorner corner = {kNoIndex, kNoIndex, kNoIndex};
        corner.position = index(word, data_.positions.size(), "vertex");
        if (word.starts_with('/')) {
            word.remove_prefix(1);
            if (!word.empty() && word[0] != '/') corner.uv = index(word, data_.uvs.size(), "texture coordinate");
            if (word.starts_with('/')) {
                word.remove_prefix(1);
                if (!word.empty()) corner.normal = index(word, data_.normals.size(), "normal");
            }
        }
        if (!word.empty()) {
            throw fault(lines_.number(), "a face's corner is v, v/vt, v//vn or v/vt/vn, all whole numbers");
        }
        return corner;
    }

    void face(std::string_view line) {
        if (current_ == nullptr) {
            const auto [found, is_new] = by_material_.try_emplace(material_, groups_.size());
            if (is_new) groups_.push_back({material_, lines_.number(), {}, {}});
            current_ = &groups_[found->second];
        }
        const std::size_t before = current_->corners.size();
        for (std::string_view word = take_word(line); !word.empty() && word[0] != '#'; word = take_word(line)) {
            current_->corners.push_back(corner(word));
        }
        const std::size_t count = current_->corners.size() - before;
        if (count < 3) {
            current_->corners.resize(before);
            short_faces_.add(lines_.number());
            return;
        }
        current_->faces.push_back({static_cast<uint32_t>(count), lines_.number()});
    }

    void check_counts() const {
        if (data_.positions.size() >= kNoIndex || data_.uvs.size() >= kNoIndex || data_.normals.size() >= kNoIndex) {
            throw Error(ErrorCode::OverLimit, fmt::format("{}: more than 2^32 - 1 vertices", file_));
        }
    }

    /// Checks a group's indices and cuts its faces into triangles.
    void finish(RawGroup& raw, ObjGroup& group, CountedLines& without) const {
        group.material = raw.material;
        group.line = raw.line;
        std::size_t triangles = 0;
        for (const Face& face : raw.faces) triangles += face.corner_count - 2;
        group.corners.reserve(3 * triangles);
        std::vector<Vec3> polygon;
        std::vector<uint32_t> cut;
        ObjCorner* corners = raw.corners.data();
        for (const Face& face : raw.faces) {
            for (uint32_t i = 0; i < face.corner_count; ++i) check(corners[i], face.line, without);
            if (face.corner_count == 3) {
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
        raw = {};
    }

    void check(ObjCorner& corner, uint32_t line, CountedLines& without) const {
        if (corner.position >= data_.positions.size()) {
            throw fault(line, fmt::format("vertex index {} is out of range; the file has {} vertices",
                                          uint64_t(corner.position) + 1, data_.positions.size()));
        }
        if (corner.uv != kNoIndex && corner.uv >= data_.uvs.size()) {
            without.add(line);
            corner.uv = kNoIndex;
        }
        if (corner.normal != kNoIndex && corner.normal >= data_.normals.size()) {
            without.add(line);
            corner.normal = kNoIndex;
        }
    }

    ObjLines lines_;
    const std::string& file_;
    Messages& messages_;
    ObjData data_;
    std::vector<RawGroup> groups_;
    std::unordered_map<std::string, std::size_t> by_material_;
    std::string material_;
    RawGroup* current_ = nullptr; // of material_; null until a face needs it
    CountedLines bad_numbers_, short_faces_, points_and_lines_, free_form_, unknown_;
};

} // namespace

ObjData parse_obj(std::span<const std::byte> bytes, const std::string& file, Messages& messages) {
    return ObjParser(text_of(bytes), file, messages).run();
}

} // namespace pertev
