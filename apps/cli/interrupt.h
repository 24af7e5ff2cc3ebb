#pragma once

// Ctrl-C and SIGTERM. While nothing has been made yet, the first ends the process at once; later it asks for an orderly
// end, and the second ends the process.

namespace pertev {

/// From now on a signal ends the process with the status of ErrorCode::Interrupted after one line that says so, with
/// `json` an object on stdout.
void end_at_interrupt(bool json);
/// From now on interrupted() hears the signals.
void listen_for_interrupt();
bool interrupted();
/// Throws Error(Interrupted): for what has nothing to bring to an end.
void throw_if_interrupted();

} // namespace pertev
