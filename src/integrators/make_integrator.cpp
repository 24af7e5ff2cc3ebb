#include "integrators/make_integrator.h"

#include "integrators/path/path_integrator.h"

namespace pertev {

bool same_light(const IntegratorSettings& a, const IntegratorSettings& b) {
    if (a.integrator != b.integrator) return false;
    switch (a.integrator) {
    case IntegratorKind::Path:
        break;
    }
    return a.path == b.path;
}

std::unique_ptr<Integrator> make_integrator(Queue& queue, const IntegratorSettings& settings) {
    switch (settings.integrator) {
    case IntegratorKind::Path:
        break;
    }
    return std::make_unique<PathIntegrator>(queue, settings.path, settings.body, settings.batch);
}

bool change_settings(Integrator& integrator, const IntegratorSettings& from, const IntegratorSettings& to) {
    if (from.integrator != to.integrator || from.body != to.body || from.batch != to.batch) return false;
    switch (to.integrator) {
    case IntegratorKind::Path:
        static_cast<PathIntegrator&>(integrator).set_settings(to.path);
        break;
    }
    return true;
}

std::size_t predicted_bytes(const IntegratorSettings& settings, uint64_t pixels, uint32_t samples, bool on_cuda,
                            bool walks_itself) {
    switch (settings.integrator) {
    case IntegratorKind::Path:
        break;
    }
    if (walks_itself && settings.body == PathBody::Loop) return 0;
    return PathIntegrator::wavefront_bytes(pixels * samples, settings.batch, on_cuda);
}

} // namespace pertev
