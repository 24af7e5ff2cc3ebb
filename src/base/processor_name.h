#pragma once

// The name of this computer's processor, for people and for records of measurements.

#include <string>

namespace pertev {

/// Returns the model name that the system gives the first processor, such as "AMD EPYC 9B45"; empty if the system has
/// no such name.
std::string processor_name();

} // namespace pertev
