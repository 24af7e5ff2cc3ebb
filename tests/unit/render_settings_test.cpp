#include "settings/render_settings.h"

#include <doctest/doctest.h>

using namespace pertev;

TEST_CASE("a picture without a size is 720 pixels high with the aspect of the scene's camera") {
    RenderSettings settings;
    settings.width = 1, settings.height = 1;
    set_default_size(settings, nullptr);
    CHECK(settings.width == 1280);
    CHECK(settings.height == 720);
    Camera camera; // the camera has no aspect
    settings.width = 1;
    set_default_size(settings, &camera);
    CHECK(settings.width == 1280);
    camera.aspect = 0.5f;
    set_default_size(settings, &camera);
    CHECK(settings.width == 360);
    CHECK(settings.height == 720);
    camera.aspect = 1e9f;
    set_default_size(settings, &camera);
    CHECK(settings.width == 8192);
}

TEST_CASE("a scene is prepared for the tracers of a session with these settings") {
    RenderSettings settings;
    for (const bool on_cuda : {false, true}) {
        CHECK(tracers_of(settings, on_cuda) == default_tracers(on_cuda));
        CHECK(prepare_options(settings, on_cuda).tracers == default_tracers(on_cuda));
    }
    settings.tracers = same_for_all({.structure = StructureKind::Ploc, .traversal = TraversalKind::Wide4});
    CHECK(prepare_options(settings, false).tracers == settings.tracers);
    CHECK(aspect_of(3, 2) == 1.5f);
}

TEST_CASE("another crop is another picture, and its film is a window of the whole") {
    RenderSettings whole, crop;
    whole.width = crop.width = 40, whole.height = crop.height = 30;
    CHECK(whole.window() == PixelWindow{.width = 40, .height = 30});
    crop.crop = PictureCrop{5, 6, 7, 8};
    CHECK(crop.window() == PixelWindow{40, 5, 6, 7, 8});
    CHECK(crop.part().end_row == 8);
    CHECK_FALSE(same_picture(whole, crop));
    RenderSettings other = crop;
    CHECK(same_picture(other, crop));
    other.crop->y = 5;
    CHECK_FALSE(same_picture(other, crop));
}
