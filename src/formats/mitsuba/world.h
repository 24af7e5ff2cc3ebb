#pragma once

// The objects of a Mitsuba file as a scene.

#include <cstdint>
#include <map>
#include <utility>
#include <vector>

#include "formats/mitsuba/bsdfs.h"
#include "formats/mitsuba/media.h"
#include "formats/mitsuba/reading.h"
#include "formats/mitsuba/shapes.h"
#include "formats/mitsuba/textures.h"
#include "formats/mitsuba/view.h"
#include "scene/scene.h"

namespace pertev::mitsuba {

class World {
public:
    /// The arguments must outlive this object.
    World(Context& context, Objects& objects);

    /// Makes the scene. `file_bytes` is the size of all XML files.
    Scene finish(uint64_t file_bytes);

private:
    void add_shape(Object& shape, const DoubleTransform& world_from_group);
    void add_instance(Object& instance);
    void place(Object& shape, const DoubleTransform& world_from_group);
    void leave_out_backs();
    float over_opacity(const Surface& surface, const Object& emitter);

    Context& context_;
    Objects& objects_;
    Parts parts_; // the first surface is the default
    Reading reading_{context_, objects_, parts_};
    Textures textures_{reading_};
    Shapes shapes_{reading_};
    Bsdfs bsdfs_{reading_, textures_};
    Media media_{reading_};
    View view_;
    std::map<std::pair<uint32_t, float>, uint32_t> area_lights_; // by the emitter's number and its factor
    uint64_t most_placed_ = 0, visited_ = 0;
};

} // namespace pertev::mitsuba
