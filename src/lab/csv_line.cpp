#include "lab/csv_line.h"

namespace pertev {
namespace {

std::string csv_text(const std::string& text) {
    if (text.find_first_of(",\"\n\r") == std::string::npos) return text;
    std::string quoted = "\"";
    for (const char c : text) {
        quoted += c;
        if (c == '"') quoted += c;
    }
    return quoted + '"';
}

} // namespace

std::string csv_line(const CsvCells& cells) {
    std::string line;
    for (const std::string& cell : cells) line += (&cell == cells.data() ? "" : ",") + csv_text(cell);
    return line + '\n';
}

} // namespace pertev
