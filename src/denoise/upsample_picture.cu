#include "denoise/upsample_picture.h"

#include "device/launch_body.h"

namespace pertev {
template void launch(Queue&, const char*, WorkCount, const UpsamplePicture&);
} // namespace pertev
