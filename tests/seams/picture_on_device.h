#pragma once

// A prepared scene on a queue's device, with a camera: the arguments of an integrator's begin().

#include "device_scene/scene_on_device.h"
#include "render/filter_table.h"
#include "render/picture_view.h"
#include "render/prepare_scene.h"
#include "tracer/scene_tracer.h"

namespace pertev::test {

struct PictureOnDevice {
    PictureOnDevice(Queue& queue, const PreparedScene& prepared, const Camera& camera, uint32_t width, uint32_t height)
        : scene(queue, prepared), tracer(queue, *prepared.structures, default_tracers(queue.is_cuda())), filter(queue) {
        tracer.set_surfaces(scene.view());
        const PixelFilter kind = PixelFilter::BlackmanHarris;
        view = {scene.view(), make_camera_rays(camera, filter.set(kind, default_filter_radius(kind)), width, height,
                                               prepared.centre)};
    }

    SceneOnDevice scene;
    SceneTracer tracer;
    FilterTable filter;
    PictureView view{};
};

} // namespace pertev::test
