#include "formats/obj/obj_pieces.h"

#include <algorithm>
#include <optional>

#include <fmt/format.h>

#include "base/parallel_for.h"
#include "formats/obj/obj_text.h"

namespace pertev {
namespace {

/// The state that a piece passes on to the next.
struct Survey {
    uint32_t lines = 0;
    ObjCounts counts = {};
    std::optional<std::string_view> object = {}, group = {}, material = {}; // last o, g and usemtl of the piece
};

/// Counts what PieceParser::statement makes from the text.
Survey survey(std::string_view text, char end_of_line) {
    Survey found;
    ObjLines lines(text, end_of_line, 1);
    for (std::string_view line; lines.next(line);) {
        const std::string_view key = take_word(line);
        if (key == "v") ++found.counts.positions;
        if (key == "vt") ++found.counts.uvs;
        if (key == "vn") ++found.counts.normals;
        if (key == "o") found.object = rest_as_name(line);
        if (key == "g") found.group = rest_as_name(line);
        if (key == "usemtl") found.material = rest_as_name(line);
    }
    found.lines = lines.number_behind() - 1;
    return found;
}

} // namespace

std::string name_of(const ObjGroupKey& key) {
    if (key.object.empty() || key.object == key.group) return std::string(key.group);
    return key.group.empty() ? std::string(key.object) : fmt::format("{}/{}", key.object, key.group);
}

std::vector<ObjPiece> cut_into_obj_pieces(std::string_view text, char end_of_line, std::size_t piece_bytes) {
    std::vector<ObjPiece> pieces;
    for (std::size_t begin = 0; begin < text.size();) {
        std::size_t end = text.find(end_of_line, std::min(begin + piece_bytes, text.size()));
        while (end != text.npos && ObjLines::is_joined(text, begin, end)) end = text.find(end_of_line, end + 1);
        const std::size_t count = end == text.npos ? text.size() - begin : end + 1 - begin;
        pieces.push_back({text.substr(begin, count)});
        begin += count;
    }
    return pieces;
}

ObjCounts count_before(std::vector<ObjPiece>& pieces, char end_of_line) {
    std::vector<Survey> found(pieces.size());
    parallel_for(pieces.size(), 1, [&](uint64_t i) { found[i] = survey(pieces[i].text, end_of_line); });
    ObjPiece before;
    for (std::size_t i = 0; i < pieces.size(); ++i) {
        before.text = pieces[i].text;
        pieces[i] = before;
        before.line += found[i].lines;
        before.counts.positions += found[i].counts.positions;
        before.counts.uvs += found[i].counts.uvs;
        before.counts.normals += found[i].counts.normals;
        before.key.object = found[i].object.value_or(before.key.object);
        before.key.group = found[i].group.value_or(before.key.group);
        before.key.material = found[i].material.value_or(before.key.material);
    }
    return before.counts;
}

} // namespace pertev
