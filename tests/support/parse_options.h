#pragma once

namespace pertev::test {

/// Reads --device and --long; everything else is doctest's.
void parse_options(int argc, char** argv);

} // namespace pertev::test
