#pragma once

// Ctrl-C and SIGTERM. Before there is any result, the first one ends the process at once; later it requests an
// orderly end, and the second one ends the process.

#include "base/sink.h"

namespace pertev {

/// Lets a signal end the process with the status of ErrorCode::Interrupted after one line that says so, with `json`
/// an object on stdout.
void end_at_interrupt(bool json);
/// Lets signals set interrupted() instead.
void listen_for_interrupt();
bool interrupted();
/// A sink that drops all messages and stops at a signal.
struct InterruptSink final : Sink {
    bool should_stop() override { return interrupted(); }
};
/// Throws Error(Interrupted) if there was a signal, for work without partial results.
void throw_if_interrupted();

} // namespace pertev
