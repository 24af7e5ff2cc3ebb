#pragma once

// The page that draws measurements: one HTML file that needs nothing else, with the JSON inside (page/report.js).

#include <span>
#include <string>
#include <string_view>

namespace pertev {

/// A file that the build has put into the program (cmake/embed_files.cmake), by its name.
std::string_view embedded_file(std::string_view name);

/// Each text is the JSON of a measurement.
std::string report_page(std::span<const std::string> measurements);

} // namespace pertev
