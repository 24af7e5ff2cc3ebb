#include "formats/obj/obj_positions.h"

#include <limits>
#include <optional>

#include "formats/files/parse_number.h"
#include "formats/obj/obj_text.h"

namespace pertev {
namespace {

/// A number is understood where PieceParser::next_number (parse_obj.cpp) does so.
double next_number(std::string_view& line) {
    skip_space(line);
    if (!line.empty() && line[0] != '#') {
        const std::optional<double> value = parse_float<double>(line);
        if (value && (line.empty() || is_obj_space(line[0]))) return *value;
        take_word(line);
    }
    return std::numeric_limits<double>::quiet_NaN();
}

} // namespace

void read_obj_positions(std::string_view piece, char end_of_line, std::span<DoubleVec3> positions) {
    ObjLines lines(piece, end_of_line, 1);
    std::size_t count = 0;
    for (std::string_view line; count < positions.size() && lines.next(line);) {
        if (take_word(line) != "v") continue;
        DoubleVec3& p = positions[count++];
        p.x = next_number(line);
        p.y = next_number(line);
        p.z = next_number(line);
    }
}

} // namespace pertev
