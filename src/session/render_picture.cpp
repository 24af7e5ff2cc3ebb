#include "session/render_picture.h"

namespace pertev {

RenderResult render_picture(Queue& queue, const PreparedScene& prepared, const Camera& camera,
                            const RenderSettings& settings,
                            const std::function<bool(const RenderProgress&)>& keep_going) {
    Session session(queue, prepared, camera, settings);
    session.render(settings.samples, keep_going);
    return session.result();
}

} // namespace pertev
