#include "denoise/contacts.h"

#include <algorithm>

#include "device/launch.h"

namespace pertev {
namespace {

constexpr uint32_t kRaysAtOnce = 1 << 18;

} // namespace

ContactFinder::ContactFinder(Queue& queue, uint32_t width, uint32_t height)
    : queue_(&queue), most_(static_cast<uint32_t>(std::min<uint64_t>(kRaysAtOnce, uint64_t(width) * height))),
      rays_(queue, most_, "rays of contacts"), starts_(queue, most_, "rays of contacts"),
      keys_(queue, most_, "rays of contacts"), found_(queue, most_, "rays of contacts") {}

void ContactFinder::find(const NoisyFrame& frame, const CameraView& camera, const SceneView& scene, SceneTracer& tracer,
                         RowBand rows, float scale) {
    const uint32_t width = frame.width();
    for (uint32_t first = rows.first * width; first < rows.end * width; first += most_) {
        const uint32_t count = std::min(most_, rows.end * width - first);
        launch(*queue_, "contact_rays", count,
               ContactRays{frame.view(), scene, camera, kReach / scale, first, rays_.data(), starts_.data(),
                           keys_.data()});
        tracer.find_occlusions({.rays = rays_.data(), .starts = starts_.data(), .keys = keys_.data()}, count,
                               {nullptr, found_.data()});
        launch(*queue_, "store_contacts", count, StoreContacts{frame.view(), found_.data(), first});
    }
}

} // namespace pertev
