// Rows that other devices take while a frame is made may be copied until the next barrier, so their owner leaves them
// as they are until then. The order of threads hides a change; this exchange, which has the whole picture, looks for
// it.

#include <doctest/doctest.h>

#include <cstring>
#include <vector>

#include "render/row_exchange.h"
#include "render/update_scene.h"
#include "session/session.h"
#include "tests/support/render_scenes.h"

using namespace pertev;

namespace {

/// Keeps the bytes of rows that others may take, and counts the arrays that have other bytes when that ends.
class WatchedRows final : public RowExchange {
public:
    explicit WatchedRows(Queue& queue) : queue_(queue) {}
    RowBand own_rows(uint32_t height) const override { return {0, height}; }
    void take(const std::vector<RowArray>& arrays, RowBand rows) override {
        end();
        for (const RowArray& array : arrays) {
            const RowBand taken = common_rows(rows, {0, array.height});
            const auto* const from = static_cast<const std::byte*>(array.data) + taken.first * array.row_bytes;
            kept_.push_back({from, bytes_at(from, taken.count() * array.row_bytes)});
        }
        ++takes;
    }
    void begin_taking_last(const std::vector<RowArray>&) override {}
    void finish_taking_last() override {}
    bool any(bool here) override { return here; }
    /// Ends a frame, or what the last take() began.
    void end() {
        for (const Kept& kept : kept_) changed += bytes_at(kept.from, kept.bytes.size()) != kept.bytes;
        kept_.clear();
    }

    int takes = 0, changed = 0;

private:
    struct Kept {
        const std::byte* from;
        std::vector<std::byte> bytes;
    };
    std::vector<std::byte> bytes_at(const std::byte* from, std::size_t count) {
        std::vector<std::byte> bytes(count);
        queue_.copy_to_host(bytes.data(), from, count);
        return bytes;
    }

    Queue& queue_;
    std::vector<Kept> kept_;
};

} // namespace

TEST_CASE("no row that other devices may be copying is changed before the next barrier") {
    Queue queue = Queue::make_cpu();
    Messages messages;
    Scene scene = test::make_mixed_scene();
    PreparedScene prepared = prepare_scene(scene, {}, messages);
    RenderSettings settings;
    settings.width = 64, settings.height = 48;
    settings.path.max_depth = 3;
    const Camera camera = test::mixed_scene_camera();
    Session session(queue, prepared, camera, settings);
    SceneUpdate update;
    update.lights_changed = true;
    WatchedRows rows(queue);
    for (const RestirLight light : {RestirLight::Off, RestirLight::Indirect}) {
        for (uint32_t k = 0; k < 4; ++k) {
            for (Light& each : scene.lights) each.intensity = 0.7f * each.intensity;
            prepared = update_scene(prepared, scene, update, messages);
            session.update_scene(prepared, parts_of(update));
            const int takes = rows.takes;
            const FrameTask task = {k, camera, settings, {.temporal_gradients = true}, {.light = light}};
            REQUIRE(session.frames().render_rows(task, &rows, messages));
            rows.end();
            if (k == 3) CHECK(rows.takes >= takes + 2); // both small pictures
        }
    }
    CHECK(rows.changed == 0);
}
