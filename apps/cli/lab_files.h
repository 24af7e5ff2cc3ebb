#pragma once

// Files and progress of the laboratory's commands.

#include <filesystem>
#include <functional>
#include <set>
#include <string>

#include "apps/cli/reporter.h"
#include "lab/measurement.h"
#include "lab/run_lab.h"

namespace pertev {

/// Makes the folder where it is missing. Throws Error(FileWrite) where nothing can be written there: asked before an
/// hour of measuring.
void check_lab_folder(const std::filesystem::path& folder);

/// Removes the regular files of these names that are there: what an earlier report wrote and this one does not.
void remove_files(const std::filesystem::path& folder, const std::set<std::string>& names);

/// report.csv, report.json and report.html, each replaced as a whole. Heat maps of an earlier report that this one does
/// not have are removed, no other file is. `head` says which machine and command.
void write_lab_files(const std::filesystem::path& folder, const LabReport& report, const Measurement& head,
                     Reporter& reporter);
/// NAME.json, and NAME.html with the pictures inside.
void write_measurement(const std::filesystem::path& folder, const std::string& name, const Measurement& measurement);
void write_text(const std::filesystem::path& path, const std::string& text);

/// A progress bar with the time left; stops at Ctrl-C. Where `folder` is not empty, what has been measured is kept
/// there after each structure, as CSV and JSON, and each heat map once it is made, two PNG files; nothing is written
/// before there is something. `reporter` outlives it.
std::function<bool(const LabProgress&)> show_lab_progress(Reporter& reporter, const std::filesystem::path& folder = {},
                                                          const Measurement& head = {});

/// Throws Error(DeviceFault) that names the combinations that differ from the proven traversal, if there are any.
void fail_if_wrong(const LabReport& report);

} // namespace pertev
