#include "session/render_picture.h"

namespace pertev {

RenderResult render_picture(Queue& queue, const PreparedScene& prepared, const Camera& camera,
                            const RenderSettings& settings, Sink& sink) {
    Session session(queue, prepared, camera, settings);
    session.render(settings.samples, sink);
    return session.result();
}

} // namespace pertev
