#include "lab/report_page.h"

namespace pertev {
namespace {

void replace(std::string& text, std::string_view from, std::string_view to) {
    for (std::size_t at = 0; (at = text.find(from, at)) != std::string::npos; at += to.size()) {
        text.replace(at, from.size(), to);
    }
}

} // namespace

std::string report_page(std::span<const std::string> measurements) {
    std::string data;
    for (const std::string& json : measurements) {
        std::string safe = json; // JSON has `<` only inside strings, where it could end the script element
        replace(safe, "<", "\\u003c");
        data += "<script type=\"application/json\" class=\"measurement\">" + safe + "</script>\n";
    }
    std::string page(embedded_file("report.html"));
    for (const char* name : {"report.css", "views.json", "plain_tables.js", "report.js"}) {
        replace(page, "{{" + std::string(name) + "}}", embedded_file(name));
    }
    replace(page, "{{data}}", data);
    return page;
}

} // namespace pertev
