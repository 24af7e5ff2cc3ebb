#include "session/pictures/render_samples.h"

#include <fmt/format.h>

#include "settings/value_names.h"

namespace pertev {

void refuse_without_samples(const RenderSettings& settings, Sink& sink) {
    if (sink.should_stop()) throw Error(ErrorCode::Interrupted, "interrupted before the first sample was complete");
    throw Error(ErrorCode::Interrupted, "time_limit", fmt::format("{:g}", settings.time_limit_s),
                fmt::format("no sample was complete in this time, so nothing is written; `integrator={}` has "
                            "precomputation before its first sample",
                            integrator_name(settings)));
}

void note_hidden_backs(const RenderStats& stats, Sink& sink) {
    if (stats.hidden_back_share > 0.01) {
        sink.note(fmt::format("{:.0f} % of the picture shows what is behind the back faces of single-sided surfaces "
                              "(`show_back_faces` shows them)",
                              100 * stats.hidden_back_share));
    }
}

RenderStats add_samples(Session& session, Sink& sink) {
    const RenderSettings& settings = session.settings();
    if (settings.range().count() > 0 && session.render(settings.range(), sink) == 0)
        refuse_without_samples(settings, sink);
    RenderStats stats = session.stats();
    note_hidden_backs(stats, sink);
    return stats;
}

RenderResult render_samples(Session& session, Sink& sink) {
    add_samples(session, sink);
    return session.result();
}

} // namespace pertev
