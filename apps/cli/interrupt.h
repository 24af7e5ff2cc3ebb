#pragma once

// Ctrl-C and SIGTERM: the first asks for an orderly end, the second ends the process at once.

namespace pertev {

/// From now on interrupted() hears the signals.
void listen_for_interrupt();
bool interrupted();

} // namespace pertev
