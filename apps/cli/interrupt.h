#pragma once

// Ctrl-C and SIGTERM: the first asks for an orderly end, the second ends the process at once.

namespace pertev {

/// From now on interrupted() hears the signals.
void listen_for_interrupt();
bool interrupted();
/// Throws Error(Interrupted): for what has nothing to bring to an end.
void throw_if_interrupted();

} // namespace pertev
