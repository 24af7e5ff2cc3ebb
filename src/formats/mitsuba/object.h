#pragma once

// An object of a Mitsuba file: an element with a plugin's type, such as <bsdf type="diffuse">, with its parameters and
// the objects in it.

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "formats/described/parameters.h"

namespace pertev::mitsuba {

using namespace described; // parts that it shares with the reader of pbrt's scenes

/// A child without a name: an object in the element, or one that <ref> names.
struct Child {
    std::string id; // for Objects::find()
    std::size_t line = 0;
};

struct Object {
    std::string tag, type, id; // "bsdf", "diffuse", and the file's own name or empty
    uint32_t number = 0;       // counts all objects of the file
    Parameters parameters;     // a child with a name is one of the type Texture, whose text is an id
    std::vector<Child> children;

    const FileLocation& location() const { return parameters.location(); }
};

/// Returns a name of Mitsuba 0.6 as that of Mitsuba 3: toWorld is to_world, intIOR is int_ior.
std::string snake_case(std::string_view name);

} // namespace pertev::mitsuba
