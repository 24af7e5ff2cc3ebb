#include "render/film_stages.h"

#include "device/launch_body.h"

namespace pertev {
template void launch(Queue&, const char*, uint32_t, const AddSums&);
template void launch(Queue&, const char*, uint32_t, const AddIds&);
template void launch(Queue&, const char*, uint32_t, const ResolveFilm&);
template void launch(Queue&, const char*, uint32_t, const DisplayFilm&);
} // namespace pertev
