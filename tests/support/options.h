#pragma once

// Options of the test binary from its command line or the environment.

#include <cstdint>
#include <filesystem>
#include <optional>

namespace pertev::test {

/// Reads --device and --long; everything else is doctest's.
void parse_options(int argc, char** argv);

/// Returns whether --device cuda was given, so that two-backend tests run on the GPU too.
bool cuda_requested();

/// Returns `count` in CI, and `long_count` with --long (or PERTEV_LONG_TESTS=1).
uint64_t effort(uint64_t count, uint64_t long_count);

/// Returns a file below the folder that PERTEV_SCENES names; nothing, with a line that says that the test is skipped,
/// if the variable is not set or there is no such file.
std::optional<std::filesystem::path> test_scene(const std::filesystem::path& relative);

/// Returns whether test_scene() found nothing so far.
bool scene_was_missing();

/// Returns a new empty folder, which is removed at exit.
std::filesystem::path scratch_folder();

} // namespace pertev::test
