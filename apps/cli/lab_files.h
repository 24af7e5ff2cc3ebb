#pragma once

// What the laboratory's command writes and shows while it runs.

#include <filesystem>
#include <functional>
#include <string>

#include "apps/cli/reporter.h"
#include "lab/run_lab.h"

namespace pertev {

/// Makes the folder where it is missing. Throws Error(FileWrite) where nothing can be written there: asked before an
/// hour of measuring.
void check_lab_folder(const std::filesystem::path& folder);

/// report.csv, report.json, report.html and a PNG for each heat map; each is replaced as a whole.
void write_lab_files(const std::filesystem::path& folder, const LabReport& report, Reporter& reporter);
void write_text(const std::filesystem::path& path, const std::string& text);

/// A progress bar with the time left; stops at Ctrl-C. Where `folder` is not empty, what has been measured is kept
/// there after each structure, as CSV and JSON; nothing is written before there is something. `reporter` outlives it.
std::function<bool(const LabProgress&)> show_lab_progress(Reporter& reporter, const std::filesystem::path& folder);

/// Throws Error(DeviceFault) that names the combinations that differ from the proven walk, if there are any.
void fail_if_wrong(const LabReport& report);

} // namespace pertev
