#pragma once

// Files of the laboratory's commands.

#include <filesystem>
#include <string>

#include "lab/measurement.h"
#include "lab/run_lab.h"

namespace pertev {

/// Makes the folder if it is missing. Throws Error(FileWrite) if nothing can be written there. Call it before an hour
/// of measuring.
void check_lab_folder(const std::filesystem::path& folder);

/// Writes NAME.csv with the named table, NAME.json, and NAME.html with the pictures inside.
void write_measurement(const std::filesystem::path& folder, const std::string& name, const Measurement& measurement,
                       std::string_view csv_table);
void write_text(const std::filesystem::path& path, const std::string& text);

/// Throws Error(DeviceFault) that names the combinations that differ from the reference traversal, if there are any.
void fail_if_wrong(const LabReport& report);

} // namespace pertev
