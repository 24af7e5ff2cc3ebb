// Renders a scene by the library: example SCENE PICTURE [SETTING VALUE]...

#include <cstdio>

#include <pertev.h>

int main(int argc, char** argv) {
    if (argc < 3) return 2;
    try {
        pertev::PictureOptions options;
        options.scene.scene = argv[1];
        for (int i = 3; i + 1 < argc; i += 2) {
            const pertev::Setting* const setting = pertev::find_setting(argv[i]);
            if (setting == nullptr) throw pertev::Error(pertev::ErrorCode::BadInput, argv[i], "", "no such setting");
            const std::string value = argv[i + 1];
            pertev::set_value(options, *setting, {&value, 1});
        }
        pertev::Messages sink; // derive from Sink to show progress, or to stop
        const auto ready = pertev::prepare_render(options, pertev::kRender, sink);
        pertev::PictureRecord record = pertev::picture_record(options, *ready, sink.messages());
        pertev::Session session(*ready->queue, ready->prepared(), record.camera.camera, ready->settings);
        session.render(ready->settings.samples, sink);
        pertev::RenderResult result = session.result();
        const std::string output = argv[2];
        const pertev::WrittenPicture written = pertev::write_picture({&output, 1}, record, result);
        std::printf("%s\n", written.hash.c_str());
        return pertev::failures_of(written).empty() ? 0 : 1;
    } catch (const pertev::Error& error) {
        std::fprintf(stderr, "%s\n", error.what());
        return pertev::exit_status(error.code());
    }
}
