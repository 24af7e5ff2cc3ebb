#pragma once

// Options of the test binary from its command line or the environment.

#include <cstdint>
#include <filesystem>
#include <optional>

namespace pertev::test {

/// --device cuda was given: two-backend tests run on the GPU too.
bool cuda_requested();

/// `count` in CI; `long_count` with --long (or PERTEV_LONG_TESTS=1).
uint64_t effort(uint64_t count, uint64_t long_count);

/// A file under the folder that PERTEV_SCENES names. Nothing, after a line that says the test is skipped, where the
/// variable is not set or the file is not there.
std::optional<std::filesystem::path> test_scene(const std::filesystem::path& relative);

/// Returns whether test_scene() found nothing so far.
bool scene_was_missing();

/// A new empty folder, removed at exit.
std::filesystem::path scratch_folder();

} // namespace pertev::test
