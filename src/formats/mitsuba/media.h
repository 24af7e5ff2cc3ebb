#pragma once

// Media of Mitsuba's files: homogeneous ones, in shapes and around a sensor.

#include <cstdint>
#include <map>
#include <optional>

#include "formats/mitsuba/reading.h"

namespace pertev::mitsuba {

class Media {
public:
    /// `reading` must outlive this object.
    explicit Media(Reading& reading) : reading_(reading) {}

    struct OfShape {
        std::optional<uint32_t> inside, outside; // indices into Parts::media
        bool ends_medium = false;                // it has a medium on either side
    };
    /// Returns what an object's parameters `interior` and `exterior` name.
    OfShape of_shape(Object& shape);
    /// Puts the medium of the first sensor around everything. A later sensor's that differs is left out.
    void set_around(Object& sensor);
    /// Finds what is around everything, after all shapes and sensors.
    void finish();

private:
    std::optional<uint32_t> read(Object& medium);
    MediumParameters read_homogeneous(Object& medium);
    float read_phase(Object& medium);

    Reading& reading_;
    std::map<uint32_t, std::optional<uint32_t>> known_; // by the object's number
    std::optional<std::optional<uint32_t>> at_sensor_;  // the first sensor's; nothing before it
};

} // namespace pertev::mitsuba
