#pragma once

// A small report of the laboratory with known contents, and the texts that tests expect.

#include <string>
#include <vector>

#include "lab/lab_report.h"

namespace pertev::test {

inline constexpr TraversalOptions kNoRta = {.rta = false};
inline constexpr TraversalOptions kFastTests = {.tests = TestKind::Fast};

/// Returns the figures of structure 0.
CombinationFigures figures(const Combination& c, std::vector<RunFigures> runs);
/// Returns the figures of a set whose runs all take `seconds`.
RunFigures timed(uint32_t set, double seconds);

/// Returns a report of a CPU with the sets primary, shadow and diffuse1 and two combinations: the default one with all
/// figures (4 Mrays/s in each set), and one that was refused before any structure was built.
LabReport small_report();

bool has(const std::string& text, const std::string& part);
std::size_t count(const std::string& text, const std::string& part);
/// Returns the first line that contains `part`; fails the test if there is none.
std::string line_with(const std::string& text, const std::string& part);

} // namespace pertev::test
