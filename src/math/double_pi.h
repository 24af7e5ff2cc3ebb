#pragma once

// Pi for what is computed in double, on the host alone; device code has kPi of math/scalar.h. It is apart from that
// because every file includes that.

namespace pertev {

inline constexpr double kPiDouble = 3.14159265358979323846;

} // namespace pertev
