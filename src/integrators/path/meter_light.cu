#include "device/launch_body.h"
#include "integrators/path/meter_light.h"

namespace pertev {
template void launch(Queue&, const char*, WorkCount, const DrawMeterLights&);
template void launch(Queue&, const char*, WorkCount, const AddMeterLights&);
} // namespace pertev
