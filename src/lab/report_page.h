#pragma once

// The page that draws measurements: one self-contained HTML file with the JSON inside (page/report.js draws it).

#include <span>
#include <string>
#include <string_view>

namespace pertev {

/// The contents of a file that the build embedded into the program (cmake/embed_files.cmake).
std::string_view embedded_file(std::string_view name);

/// Makes the page; each text is the JSON of one measurement.
std::string report_page(std::span<const std::string> measurements);

} // namespace pertev
