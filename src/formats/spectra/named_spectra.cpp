#include "formats/spectra/named_spectra.h"

#include <algorithm>
#include <string>

#include "base/lower_case.h"
#include "formats/spectra/spectrum.h"
#include "scene/metals.h"

namespace pertev {
namespace {

struct ShortName {
    std::string_view name, metal; // `name` is pbrt's, in its case
};
constexpr ShortName kShortNames[] = {{"a-C", "carbon"},
                                     {"Ag", "silver"},
                                     {"Al", "aluminium"},
                                     {"AlAs", "aluminium-arsenide"},
                                     {"AlSb", "aluminium-antimonide"},
                                     {"Au", "gold"},
                                     {"Be", "beryllium"},
                                     {"Co", "cobalt"},
                                     {"Cr", "chromium"},
                                     {"CsI", "caesium-iodide"},
                                     {"Cu", "copper"},
                                     {"CuZn", "brass"},
                                     {"Fe", "iron"},
                                     {"Hg", "mercury"},
                                     {"Ir", "iridium"},
                                     {"K", "potassium"},
                                     {"Li", "lithium"},
                                     {"Mo", "molybdenum"},
                                     {"Na", "sodium"},
                                     {"Nb", "niobium"},
                                     {"Ni", "nickel"},
                                     {"Pd", "palladium"},
                                     {"Pt", "platinum"},
                                     {"Rh", "rhodium"},
                                     {"SiC", "silicon-carbide"},
                                     {"Ta", "tantalum"},
                                     {"Te", "tellurium"},
                                     {"Ti", "titanium"},
                                     {"TiC", "titanium-carbide"},
                                     {"TiN", "titanium-nitride"},
                                     {"V", "vanadium"},
                                     {"VC", "vanadium-carbide"},
                                     {"VN", "vanadium-nitride"},
                                     {"W", "tungsten"}};

struct Crystal {
    std::string_view name;
    ComplexIndex index;
};
// The ordinary index at 587.6 nm. Source: refractiveindex.info, Stephens and Malitson 1952 (MgO), Devore 1951 (TiO2).
constexpr Crystal kCrystals[] = {{"MgO", {{1.7373f, 1.7373f, 1.7373f}, {0, 0, 0}}},
                                 {"TiO2", {{2.6142f, 2.6142f, 2.6142f}, {0, 0, 0}}}};

struct NamedGlass {
    std::string_view name;
    GlassIndex glass;
};
// Source: Schott's data sheets.
constexpr NamedGlass kGlasses[] = {{"BK7", {1.5168f, 64.17f}},    {"BAF10", {1.67003f, 47.11f}},
                                   {"FK51A", {1.48656f, 84.47f}}, {"LASF9", {1.85025f, 32.17f}},
                                   {"F5", {1.67271f, 32.25f}},    {"F10", {1.72825f, 28.53f}},
                                   {"F11", {1.78472f, 25.68f}}};

struct Illuminant {
    std::string_view name;
    double x, y; // CIE 1931
};
// Source: CIE 15, tables of chromaticities; SMPTE ST 2065-1 for D60.
constexpr Illuminant kIlluminants[] = {
    {"stdillum-A", 0.44758, 0.40745},    {"stdillum-D50", 0.34567, 0.35851}, {"stdillum-D65", 0.31272, 0.32903},
    {"illum-acesD60", 0.32168, 0.33767}, {"stdillum-F1", 0.3131, 0.3371},    {"stdillum-F2", 0.3721, 0.3751},
    {"stdillum-F3", 0.4091, 0.3941},     {"stdillum-F4", 0.4402, 0.4031},    {"stdillum-F5", 0.3138, 0.3452},
    {"stdillum-F6", 0.3779, 0.3882},     {"stdillum-F7", 0.3129, 0.3292},    {"stdillum-F8", 0.3458, 0.3586},
    {"stdillum-F9", 0.3741, 0.3727},     {"stdillum-F10", 0.3458, 0.3588},   {"stdillum-F11", 0.3805, 0.3769},
    {"stdillum-F12", 0.4370, 0.4042}};

template <class Table>
auto find_named(const Table& table, std::string_view name) {
    return std::ranges::find(table, lower_case(name), [](const auto& row) { return lower_case(row.name); });
}

} // namespace

std::optional<ComplexIndex> find_metal_index(std::string_view name) {
    if (const auto* found = find_named(kCrystals, name); found != std::end(kCrystals)) return found->index;
    const auto* found = find_named(kShortNames, name);
    const MeasuredMetal* const metal =
        find_metal(found != std::end(kShortNames) ? std::string(found->metal) : lower_case(name));
    if (metal == nullptr) return std::nullopt;
    return ComplexIndex{metal->eta, metal->k};
}

std::optional<GlassIndex> find_glass(std::string_view name) {
    // pbrt calls Schott's SF11 F11.
    const bool is_long = lower_case(name).starts_with("sf");
    const auto* found = find_named(kGlasses, is_long ? name.substr(1) : name);
    if (found == std::end(kGlasses)) return std::nullopt;
    return found->glass;
}

std::optional<Rgb> find_illuminant(std::string_view name) {
    const auto* found = find_named(kIlluminants, name);
    if (found == std::end(kIlluminants)) return std::nullopt;
    return color_of_chromaticity(found->x, found->y);
}

std::vector<std::string> names_of_spectra() {
    std::vector<std::string> names;
    const auto add_metal = [&](std::string_view metal) {
        for (const char* const part : {"-eta", "-k"}) names.push_back("metal-" + std::string(metal) + part);
    };
    for (const ShortName& row : kShortNames) add_metal(row.name);
    for (const Crystal& row : kCrystals) add_metal(row.name);
    for (const NamedGlass& row : kGlasses) names.push_back("glass-" + std::string(row.name));
    for (const Illuminant& row : kIlluminants) names.emplace_back(row.name);
    return names;
}

} // namespace pertev
