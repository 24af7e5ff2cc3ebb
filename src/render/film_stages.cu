#include "render/film_stages.h"

#include "device/launch_body.h"

namespace pertev {
template void launch(Queue&, const char*, WorkCount, const AddSums&);
template void launch(Queue&, const char*, WorkCount, const AddIds&);
template void launch(Queue&, const char*, WorkCount, const AddMissing&);
template void launch(Queue&, const char*, WorkCount, const AddCounts&);
template void launch(Queue&, const char*, WorkCount, const AddFrames&);
template void launch(Queue&, const char*, WorkCount, const ResolveFilm&);
template void launch(Queue&, const char*, WorkCount, const DisplayFilm&);
} // namespace pertev
