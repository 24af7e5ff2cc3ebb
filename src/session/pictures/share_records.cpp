#include "session/pictures/share_records.h"

#include <algorithm>
#include <string_view>

#include "base/error.h"
#include "base/stopwatch.h"
#include "integrators/irradiance_cache/irradiance_cache_settings.h"
#include "session/picture_renderer.h"
#include "session/records/records_file.h"
#include "session/render_progress.h"
#include "settings/setting_table.h"

namespace pertev {
namespace {

/// Returns all that decides the picture, except for what takes samples of the records or shows them.
DecidingSettings what_decides(const PictureOptions& options, PictureRecord record) {
    std::erase_if(record.scene.files, &FileOfPicture::is_lut);
    DecidingSettings settings = deciding_settings(options, record);
    std::erase_if(settings, [](const auto& entry) {
        if (entry.first == "scene") return true; // its name; its hash counts
        const Setting* const setting = find_setting(entry.first);
        return setting != nullptr && (setting->is_after_records || setting->changes == Changes::Display);
    });
    return settings;
}

/// Leaves the records of the picture in the settings' shared ones, which are empty.
void make_records(RenderSetup& ready, const PictureRecord& record, Sink& sink) {
    sink.set_work("making irradiance records");
    const RenderSettings& settings = record.settings;
    DeviceScene scene(*ready.queue);
    scene.set(ready.prepared(), settings);
    PictureRenderer pictures(scene);
    Integrator& integrator = pictures.begin(record.camera.camera, settings, 1);
    const Stopwatch watch;
    const bool is_made = integrator.prepare([&](double share) {
        return sink.goes_on(made_progress(0, settings.range().count(), share, watch.seconds(), integrator.rays()));
    });
    if (!is_made) throw Error(ErrorCode::Interrupted, "interrupted before the irradiance records were made");
}

} // namespace

void share_records(const PictureOptions& options, RenderSetup& ready, PictureRecord& record, Sink& sink) {
    const std::string& name = options.radiosity.records;
    RenderSettings& settings = record.settings;
    if (name.empty() || !makes_records(settings.integrator)) return;
    const RecordsFile file(name, what_decides(options, record));
    std::optional<std::vector<std::byte>> known = file.read();
    const auto records = std::make_shared<std::vector<std::byte>>(known ? std::move(*known) : std::vector<std::byte>());
    settings.irradiance_cache.edit().shared = records;
    if (!known) {
        make_records(ready, record, sink);
        file.write(*records);
    } else if (records->empty()) {
        throw file.damaged("the file does not hold records");
    }
    ready.settings.irradiance_cache = settings.irradiance_cache;
}

} // namespace pertev
