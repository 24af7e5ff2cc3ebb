#pragma once

// The state that the readers of a Mitsuba file's objects share.

#include "formats/described/parts.h"
#include "formats/mitsuba/context.h"
#include "formats/mitsuba/objects.h"

namespace pertev::mitsuba {

struct Reading {
    Context& context;
    Objects& objects;
    Parts& parts;
    int depth = 0; // counts objects in each other (Depth)

    Sink& sink() const { return context.sink; }
    /// Returns the object of a parameter; null after a warning if there is none, or if the parameter is no object.
    Object* object_of(const Object& in, const Parameter& parameter);
};

/// Returns the transform of a parameter; the identity without one or if it is unreadable.
DoubleTransform transform_of(Object& object, std::string_view name, Sink& sink);
/// Returns the texture, spectrum, bsdf or other object `tag` among an object's children without names; null if there
/// is none. Throws Error(BadInput) if one refers to nothing.
Object* child_of(Object& object, std::string_view tag, Reading& reading);
/// Returns the children without names whose tags are none of `used`.
std::vector<Object*> objects_without_use(const Object& object, std::initializer_list<std::string_view> used,
                                         Reading& reading);
/// Returns the objects `tag` in an object, with and without names.
std::vector<Object*> objects_in(Object& object, std::string_view tag, Reading& reading);

} // namespace pertev::mitsuba
