#pragma once

// The light transport report as a measurement: tables "scenes", "equal_time" (smallest error
// first), "points" (means over repetitions) and "repetitions" (a row for each compared picture, and a row with the
// reason for each integrator without figures).

#include <string>

#include "lab/measurement.h"
#include "lab/transport_report.h"

namespace pertev {

/// Makes the tables of a report. `head` names the machine and the command.
Measurement measurement_of(const TransportReport& report, Measurement head = {});
/// Returns text for a terminal: for each scene the reference, the table at equal time, integrators without figures and
/// why, and notes.
std::string text_of(const TransportReport& report);

/// Compares integrators at the longest time that all of a scene's integrators reached.
ResultTable equal_time_table(const TransportScene& scene);

} // namespace pertev
