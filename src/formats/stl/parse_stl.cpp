#include "formats/stl/parse_stl.h"

#include <algorithm>
#include <cstring>
#include <limits>
#include <optional>
#include <string_view>

#include <fmt/format.h>

#include "base/error.h"
#include "base/limits.h"
#include "base/lower_case.h"
#include "base/message_text.h"
#include "formats/files/parse_number.h"
#include "formats/mesh/triangulate_polygon.h"

namespace pertev {
namespace {

constexpr std::size_t kHeaderBytes = 84, kTriangleBytes = 50;

bool is_stl_space(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\n'; }

void check_triangle_count(uint64_t count, const std::string& file) {
    if (count <= kMaxTrianglesPerMesh) return;
    throw Error(ErrorCode::OverLimit, FileLocation{file},
                fmt::format("{} triangles; a file may have at most {}", count, kMaxTrianglesPerMesh));
}

/// A kind of fault that is reported once, with its first line.
struct StlFaults {
    std::size_t times = 0, first_line = 0;

    void add(std::size_t line) {
        if (times++ == 0) first_line = line;
    }
};

class StlText {
public:
    StlText(std::string_view text, const std::string& file, Sink& sink) : text_(text), file_(file), sink_(sink) {}

    StlData run() {
        for (std::string_view word = next_word(); !word.empty(); word = next_word()) {
            sink_.check_at(words_++);
            statement(lower_case(word.substr(0, 16)));
        }
        const bool is_cut_off = is_in_facet_ && facet_.size() < 3;
        if (!is_cut_off) end_facet();
        if (is_cut_off) sink_.leave_out({FileLocation{file_, facet_line_}, "the file ends within this facet"});
        report(strays_, "facet", "with fewer than three readable corners");
        report(unknown_, "word", "that STL does not have");
        return std::move(data_);
    }

private:
    std::string_view next_word() {
        for (; at_ < text_.size() && is_stl_space(text_[at_]); ++at_) {
            line_ += text_[at_] == '\n' || (text_[at_] == '\r' && text_.substr(at_ + 1, 1) != "\n");
        }
        const std::size_t begin = at_;
        while (at_ < text_.size() && !is_stl_space(text_[at_])) ++at_;
        return text_.substr(begin, at_ - begin);
    }

    std::string_view rest_of_line() {
        const std::size_t begin = at_, end = std::min(text_.find_first_of("\r\n", at_), text_.size());
        at_ = end;
        std::string_view rest = text_.substr(begin, end - begin);
        while (!rest.empty() && is_stl_space(rest.front())) rest.remove_prefix(1);
        while (!rest.empty() && is_stl_space(rest.back())) rest.remove_suffix(1);
        return rest;
    }

    void statement(const std::string& word) {
        if (word == "vertex") {
            corner();
        } else if (word == "facet") {
            end_facet();
            is_in_facet_ = true;
            facet_line_ = line_;
        } else if (word == "normal") {
            for (int i = 0; i < 3; ++i) take_number();
        } else if (word == "endfacet") {
            end_facet();
        } else if (word == "solid") {
            end_facet();
            data_.solids.push_back({.name = std::string(rest_of_line()), .line = line_});
        } else if (word == "endsolid") {
            end_facet();
            rest_of_line();
        } else if (word != "outer" && word != "loop" && word != "endloop") {
            unknown_.add(line_);
        }
    }

    /// Parses and removes the next word if it is a number.
    std::optional<double> take_number() {
        const std::size_t at = at_, line = line_;
        std::string_view word = next_word();
        const std::optional<double> number = parse_float<double>(word);
        if (number && word.empty()) return number;
        at_ = at;
        line_ = line;
        return std::nullopt;
    }

    void corner() {
        double p[3];
        for (double& x : p) {
            const std::optional<double> number = take_number();
            if (!number) return; // the facet has a corner too few
            x = *number;
        }
        facet_.push_back({p[0], p[1], p[2]});
    }

    /// Adds the present facet. Some programs write polygons.
    void end_facet() {
        if (!is_in_facet_ && facet_.empty()) return;
        is_in_facet_ = false;
        if (facet_.size() < 3) strays_.add(facet_line_);
        polygon_.clear();
        for (const DoubleVec3& p : facet_) polygon_.push_back(to_float(p));
        cut_.clear();
        triangulate_polygon(polygon_, cut_);
        check_triangle_count((data_.corners.size() + cut_.size()) / 3, file_);
        if (data_.solids.empty()) data_.solids.push_back({.line = facet_line_});
        data_.solids.back().triangles += cut_.size() / 3;
        for (const uint32_t i : cut_) {
            data_.corners.push_back(polygon_[i]);
            data_.exact.push_back(facet_[i]);
        }
        facet_.clear();
    }

    void report(const StlFaults& faults, const char* thing, const char* which) {
        if (faults.times == 0) return;
        sink_.leave_out(
            {FileLocation{file_, faults.first_line},
             fmt::format("{} {} {} left out", counted(faults.times, thing), which, is_or_are(faults.times))});
    }

    std::string_view text_;
    const std::string& file_;
    Sink& sink_;
    std::size_t at_ = 0, line_ = 1, facet_line_ = 0;
    uint64_t words_ = 0;
    bool is_in_facet_ = false;
    std::vector<DoubleVec3> facet_; // corners of the present facet
    std::vector<Vec3> polygon_;
    std::vector<uint32_t> cut_;
    StlFaults strays_, unknown_;
    StlData data_;
};

/// Reads as many triangles as the file holds, at most the stated ones.
StlData parse_binary(std::span<const std::byte> bytes, uint32_t stated, const std::string& file, Sink& sink) {
    const std::size_t held = (bytes.size() - kHeaderBytes) / kTriangleBytes;
    const std::size_t rest = (bytes.size() - kHeaderBytes) % kTriangleBytes;
    std::size_t count = std::min<std::size_t>(stated, held);
    if (stated == 0 && rest == 0 && held > 0) { // written before the triangles were counted
        count = held;
        sink.warn({FileLocation{file}, fmt::format("the header states no triangles; the file has {}", held)});
    } else if (stated > held) {
        sink.leave_out({FileLocation{file}, fmt::format("the file ends after {} of {} triangles", held, stated)});
    } else if (stated < held || rest > 0) {
        sink.leave_out({FileLocation{file}, fmt::format("{} bytes after the last triangle are left out",
                                                        bytes.size() - kHeaderBytes - count * kTriangleBytes)});
    }
    check_triangle_count(count, file);
    StlData data;
    data.corners.reserve(3 * count);
    const std::string_view header(reinterpret_cast<const char*>(bytes.data()), kHeaderBytes - 4);
    bool has_colours = header.find("COLOR=") != header.npos;
    for (std::size_t i = 0; i < count; ++i) {
        sink.check_at(i);
        const std::byte* triangle = bytes.data() + kHeaderBytes + i * kTriangleBytes;
        Vec3 corners[3];
        static_assert(sizeof(corners) == 36);
        std::memcpy(corners, triangle + 12, sizeof(corners));
        data.corners.insert(data.corners.end(), corners, corners + 3);
        has_colours |= (triangle[49] & std::byte(0x80)) != std::byte(0);
    }
    if (has_colours) sink.leave_out({FileLocation{file}, "colours of triangles are left out"});
    data.solids.push_back({.triangles = count});
    return data;
}

/// Returns whether bytes could be text: no control characters but spaces.
bool is_text(std::string_view bytes) {
    return std::ranges::none_of(bytes, [](char c) { return c >= 0 && c < ' ' && !is_stl_space(c) && c != '\f'; });
}

} // namespace

StlData parse_stl(std::span<const std::byte> bytes, const std::string& file, Sink& sink) {
    std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    const std::string_view begin = text.substr(0, 1024); // it holds a binary file's count, which is no text
    if (is_text(begin)) {
        if (text.starts_with("\xef\xbb\xbf")) text.remove_prefix(3);
        PartMessages messages(sink);
        StlData data = StlText(text, file, messages).run();
        if (!data.solids.empty()) { // otherwise not one word is STL's
            sink.add_all(messages);
            return data;
        }
    } else if (bytes.size() >= kHeaderBytes + kTriangleBytes) {
        uint32_t stated = 0;
        std::memcpy(&stated, bytes.data() + kHeaderBytes - 4, 4);
        return parse_binary(bytes, stated, file, sink);
    }
    throw Error(ErrorCode::BadInput, FileLocation{file},
                "neither a text of solids and facets nor 84 bytes and 50 for each triangle, as STL is");
}

} // namespace pertev
