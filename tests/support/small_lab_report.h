#pragma once

// A report of the laboratory that is small enough to know by heart, and what tests look for in its texts.

#include <string>
#include <vector>

#include "lab/lab_report.h"

namespace pertev::test {

inline constexpr TraversalOptions kNoRta = {.rta = false};
inline constexpr TraversalOptions kFastTests = {.tests = TestKind::Fast};

/// Figures of structure 0, with its own name.
CombinationFigures figures(const Combination& c, std::vector<RunFigures> runs);
/// Every run took so long.
RunFigures timed(uint32_t set, double seconds);

/// A CPU's: primary, shadow and diffuse1; the default combination with everything (speeds 4, 4 and 4 Mrays/s), and one
/// refused before any structure was built.
LabReport small_report();

bool has(const std::string& text, const std::string& part);
std::size_t count(const std::string& text, const std::string& part);
/// The first line with `part` in it; fails the test where there is none.
std::string line_with(const std::string& text, const std::string& part);

} // namespace pertev::test
