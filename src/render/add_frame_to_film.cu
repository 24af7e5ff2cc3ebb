#include "render/add_frame_to_film.h"

#include "device/launch_body.h"

namespace pertev {
template void launch(Queue&, const char*, WorkCount, const AddFrameToFilm&);
} // namespace pertev
