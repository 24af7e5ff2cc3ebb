#pragma once

// Names of objects and materials as Cryptomatte ids: the 32 bits of MurmurHash3 of a name in UTF-8, seed 0, of which
// one bit of the exponent is inverted where the bits would be a float that is zero, subnormal, infinite or not a
// number.
//
// Source: Friedman, Jones, "Fully Automatic ID Mattes with Support for Motion Blur and Transparency", SIGGRAPH 2015
// posters; Cryptomatte specification 1.2.0, "ID Generation" and "Metadata"; Appleby, MurmurHash3, x86, 32 bits.

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "scene/scene.h"

namespace pertev {

/// Returns the hash of a text with seed 0.
uint32_t murmur_hash3(std::string_view text);
/// Returns the bits of the float that stands for a name in files.
uint32_t matte_id(std::string_view name);

/// Ids by instance and by material, and names by them. Things of one name have one id; what has none is called
/// "instance N" or "material N" by its number.
struct MatteNames {
    explicit MatteNames(const Scene& scene);

    std::vector<uint32_t> object_ids, material_ids; // [instances], [materials]
    std::vector<std::string> objects, materials;    // names by the same number
};

/// Returns the entries of an EXR's header that describe a type of mattes, whose layers' names begin with `type`. The
/// manifest has those of `names` whose id is one of `shown`, which is sorted.
std::vector<std::pair<std::string, std::string>>
matte_metadata(const std::string& type, std::span<const std::string> names, std::span<const uint32_t> shown);

} // namespace pertev
