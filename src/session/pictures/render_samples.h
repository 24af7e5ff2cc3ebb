#pragma once

// Renders the samples of a still picture, and says what a person should know of the outcome.

#include "base/sink.h"
#include "session/session.h"

namespace pertev {

/// Adds the settings' samples to the film, fewer if their time is over or `sink` stops, and returns the result. Notes
/// if the camera looks through the backs of surfaces. Throws Error(Interrupted) if there was no time for a sample, and
/// as Session::render.
RenderResult render_samples(Session& session, Sink& sink);
/// Adds samples as render_samples() for a caller that reads the session's film. Returns only statistics.
RenderStats add_samples(Session& session, Sink& sink);

// The end of such a render.

/// Throws the Error(Interrupted) that says why there was no time for a sample.
[[noreturn]] void refuse_without_samples(const RenderSettings& settings, Sink& sink);
/// Notes if the camera looks through the backs of surfaces.
void note_hidden_backs(const RenderStats& stats, Sink& sink);

} // namespace pertev
