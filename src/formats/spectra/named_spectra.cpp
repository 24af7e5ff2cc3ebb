#include "formats/spectra/named_spectra.h"

#include <algorithm>
#include <string>

#include "base/lower_case.h"
#include "formats/spectra/spectrum.h"
#include "scene/metals.h"

namespace pertev {
namespace {

struct ShortName {
    std::string_view name, metal;
};
constexpr ShortName kShortNames[] = {{"a-c", "carbon"},
                                     {"ag", "silver"},
                                     {"al", "aluminium"},
                                     {"alas", "aluminium-arsenide"},
                                     {"alsb", "aluminium-antimonide"},
                                     {"au", "gold"},
                                     {"be", "beryllium"},
                                     {"co", "cobalt"},
                                     {"cr", "chromium"},
                                     {"csi", "caesium-iodide"},
                                     {"cu", "copper"},
                                     {"cuzn", "brass"},
                                     {"fe", "iron"},
                                     {"hg", "mercury"},
                                     {"ir", "iridium"},
                                     {"k", "potassium"},
                                     {"li", "lithium"},
                                     {"mo", "molybdenum"},
                                     {"na", "sodium"},
                                     {"nb", "niobium"},
                                     {"ni", "nickel"},
                                     {"pd", "palladium"},
                                     {"pt", "platinum"},
                                     {"rh", "rhodium"},
                                     {"sic", "silicon-carbide"},
                                     {"ta", "tantalum"},
                                     {"te", "tellurium"},
                                     {"ti", "titanium"},
                                     {"tic", "titanium-carbide"},
                                     {"tin", "titanium-nitride"},
                                     {"v", "vanadium"},
                                     {"vc", "vanadium-carbide"},
                                     {"vn", "vanadium-nitride"},
                                     {"w", "tungsten"}};

struct Crystal {
    std::string_view name;
    ComplexIndex index;
};
// The ordinary index at 587.6 nm. Source: refractiveindex.info, Stephens and Malitson 1952 (MgO), Devore 1951 (TiO2).
constexpr Crystal kCrystals[] = {{"mgo", {{1.7373f, 1.7373f, 1.7373f}, {0, 0, 0}}},
                                 {"tio2", {{2.6142f, 2.6142f, 2.6142f}, {0, 0, 0}}}};

struct NamedGlass {
    std::string_view name;
    GlassIndex glass;
};
// Source: Schott's data sheets.
constexpr NamedGlass kGlasses[] = {{"bk7", {1.5168f, 64.17f}},    {"baf10", {1.67003f, 47.11f}},
                                   {"fk51a", {1.48656f, 84.47f}}, {"lasf9", {1.85025f, 32.17f}},
                                   {"sf5", {1.67271f, 32.25f}},   {"sf10", {1.72825f, 28.53f}},
                                   {"sf11", {1.78472f, 25.68f}}};

struct Illuminant {
    std::string_view name;
    double x, y; // CIE 1931
};
// Source: CIE 15, tables of chromaticities; SMPTE ST 2065-1 for D60.
constexpr Illuminant kIlluminants[] = {
    {"stdillum-a", 0.44758, 0.40745},    {"stdillum-d50", 0.34567, 0.35851}, {"stdillum-d65", 0.31272, 0.32903},
    {"illum-acesd60", 0.32168, 0.33767}, {"stdillum-f1", 0.3131, 0.3371},    {"stdillum-f2", 0.3721, 0.3751},
    {"stdillum-f3", 0.4091, 0.3941},     {"stdillum-f4", 0.4402, 0.4031},    {"stdillum-f5", 0.3138, 0.3452},
    {"stdillum-f6", 0.3779, 0.3882},     {"stdillum-f7", 0.3129, 0.3292},    {"stdillum-f8", 0.3458, 0.3586},
    {"stdillum-f9", 0.3741, 0.3727},     {"stdillum-f10", 0.3458, 0.3588},   {"stdillum-f11", 0.3805, 0.3769},
    {"stdillum-f12", 0.4370, 0.4042}};

template <class Table>
auto find_named(const Table& table, std::string_view name) {
    return std::ranges::find(table, lower_case(name), [](const auto& row) { return row.name; });
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
    const std::string lower = lower_case(name);
    const bool is_short = lower == "f5" || lower == "f10" || lower == "f11";
    const auto* found = find_named(kGlasses, is_short ? "s" + lower : lower);
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
