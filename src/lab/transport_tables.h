#pragma once

// The report on light transport as a measurement: tables "scenes", "equal_time" and "equal_samples" (the least error
// first), "points" (means over repetitions), and "repetitions", a row for each picture that was compared and one with
// the reason for each integrator without figures.

#include <string>

#include "lab/measurement.h"
#include "lab/transport_report.h"

namespace pertev {

/// `head` says which machine and command.
Measurement measurement_of(const TransportReport& report, Measurement head = {});
/// The table "repetitions".
std::string csv_of(const TransportReport& report);
/// For a terminal: for each scene the reference, both tables at equal work, what has no figures and why, and notes.
std::string text_of(const TransportReport& report);

/// At the time that all integrators of a scene have come to, and at the samples that all of them have.
ResultTable equal_time_table(const TransportScene& scene);
ResultTable equal_samples_table(const TransportScene& scene);

} // namespace pertev
