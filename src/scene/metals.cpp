#include "scene/metals.h"

#include <algorithm>
#include <iterator>

namespace pertev {
namespace {

constexpr MeasuredMetal kMetals[] = {
#include "scene/metal_table.inl"
};

} // namespace

std::span<const MeasuredMetal> measured_metals() { return kMetals; }

const MeasuredMetal* find_metal(std::string_view name) {
    const auto* const found = std::ranges::find(kMetals, name, &MeasuredMetal::name);
    return found == std::end(kMetals) ? nullptr : found;
}

std::string names_of_metals() {
    std::string names;
    for (const MeasuredMetal& metal : kMetals) {
        if (!names.empty()) names += ", ";
        names += metal.name;
    }
    return names;
}

} // namespace pertev
