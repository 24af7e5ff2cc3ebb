#pragma once

// The report as one HTML file that needs nothing else: what differs from the proven walk first, then the tables of
// html_tables.h and the pictures of html_plots.h.

#include <string>

#include "lab/lab_report.h"

namespace pertev {

std::string html_of(const LabReport& report);

/// The pieces, for pages of other shapes.
std::string html_page(const std::string& title, const std::string& body);
/// An <img> with the picture inside.
std::string html_image(const Rgba8Image& image, const std::string& caption, uint32_t shown_width);

} // namespace pertev
