#pragma once

// The report on light transport for a terminal, as HTML, CSV and JSON.

#include <string>

#include "lab/transport_report.h"

namespace pertev {

/// For each scene: the reference, two tables (at equal time and at equal samples, the least error first), what has no
/// figures and why, and notes.
std::string text_of(const TransportReport& report);

/// One HTML file that needs nothing else: the same tables, curves of the errors over time and over samples with their
/// confidence bands, pictures.
std::string html_of(const TransportReport& report);

/// Comma-separated, with a header line: a line for each picture that was compared, and one with the reason for each
/// integrator that has no figures. What was not measured is empty.
std::string csv_of(const TransportReport& report);

/// One JSON object: what was measured and what follows from it, but no pictures. What was not measured is null.
std::string json_of(const TransportReport& report);

// Pieces that these share. Rows for align_columns and html_table, the head first; a head alone where nothing is there.
using TransportTable = std::vector<std::vector<std::string>>;
TransportTable equal_time_table(const TransportScene& scene);
TransportTable equal_samples_table(const TransportScene& scene);
/// "path, 1024 samples, 12.3 s; its noise: relMSE 1e-05"
std::string describe_reference(const TransportReference& reference);
/// "cast: point, spot and ... lights alone", a line for each integrator without figures.
std::vector<std::string> rows_without_figures(const TransportScene& scene);

} // namespace pertev
