#include "settings/value_names.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace pertev {

std::string_view integrator_name(const RenderSettings& settings) {
    return settings.integrator == IntegratorKind::Path ? name_of(settings.path.light) : name_of(settings.integrator);
}

bool set_integrator(RenderSettings& settings, std::string_view name) {
    const std::optional<PathLight> light = value_named<PathLight>(name);
    const std::optional<IntegratorKind> kind = light ? IntegratorKind::Path : value_named<IntegratorKind>(name);
    if (!kind) return false;
    settings.integrator = *kind;
    settings.path.light = light.value_or(PathLight::Path);
    return true;
}

std::vector<std::string> integrator_names(uint32_t kinds) {
    std::vector<std::string> names;
    for (const IntegratorDescriptor& integrator : integrators()) {
        if ((kinds >> static_cast<uint32_t>(integrator.value) & 1u) == 0) continue;
        if (integrator.value == IntegratorKind::Path) {
            names = names_of<PathLight>(); // it is the first
        } else {
            names.emplace_back(integrator.name);
        }
    }
    return names;
}

std::string list_of(const std::vector<std::string>& integrators) {
    return fmt::format("`integrator={}`{}{}", integrators.front(), integrators.size() > 1 ? ", " : "",
                       fmt::join(integrators.begin() + 1, integrators.end(), ", "));
}

uint32_t integrators_that(bool (*has)(IntegratorKind)) {
    uint32_t bits = 0;
    for (const IntegratorDescriptor& integrator : integrators()) {
        if (has(integrator.value)) bits |= 1u << static_cast<uint32_t>(integrator.value);
    }
    return bits;
}

} // namespace pertev
