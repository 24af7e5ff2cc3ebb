#pragma once

// Media of Mitsuba's files: homogeneous ones, in shapes and around a sensor.

#include <cstdint>
#include <map>
#include <optional>
#include <set>

#include "formats/mitsuba/reading.h"

namespace pertev::mitsuba {

class Media {
public:
    /// Outlives it.
    explicit Media(Reading& reading) : reading_(reading) {}

    struct OfShape {
        std::optional<uint32_t> inside; // index into Parts::media
        bool ends_medium = false;       // it has a medium on either side
    };
    /// Returns what an object's parameters `interior` and `exterior` name.
    OfShape of_shape(Object& shape);
    /// Puts the sensor's medium around everything.
    void set_around(Object& sensor);
    /// Leaves out the media outside of shapes that fill no other shape and are not around the sensor.
    void finish();

private:
    std::optional<uint32_t> read(Object& medium);
    MediumParameters read_homogeneous(Object& medium);
    float read_phase(Object& medium);

    Reading& reading_;
    std::map<uint32_t, std::optional<uint32_t>> known_; // by the object's number
    std::map<uint32_t, FileLocation> outside_;          // media by index
    std::set<uint32_t> inside_;
};

} // namespace pertev::mitsuba
