#pragma once

// The pictures of chapters 2 to 4 of the thesis as a table, HTML, CSV and JSON.

#include <span>
#include <string>
#include <vector>

#include "lab/thesis_pictures.h"

namespace pertev {

/// Rows for align_columns and html_table, the head first: how each was made, and in which time.
std::vector<std::vector<std::string>> table_of(std::span<const ThesisPicture> pictures);

/// A heading for each chapter and figure, pictures of one figure side by side.
std::string html_of(std::span<const ThesisPicture> pictures);

/// Comma-separated, with a header line: a line a picture. What it has not got is empty.
std::string csv_of(std::span<const ThesisPicture> pictures);
/// A list of JSON objects. What a picture has not got is null.
std::string json_of(std::span<const ThesisPicture> pictures);

} // namespace pertev
