#include "lab/html_table.h"

#include <fmt/format.h>

#include "lab/svg_plot.h"

namespace pertev {

std::string html_table(const std::vector<std::vector<std::string>>& table) {
    std::string rows;
    for (std::size_t i = 0; i < table.size(); ++i) {
        const char* tag = i == 0 ? "th" : "td";
        rows += "<tr>";
        for (const std::string& text : table[i]) rows += fmt::format("<{0}>{1}</{0}>", tag, html_text(text));
        rows += "</tr>\n";
    }
    return fmt::format("<table>{}</table>\n", rows);
}

} // namespace pertev
