#include "formats/mitsuba/read_mitsuba.h"

#include "base/read_file.h"
#include "formats/files/load_textures.h"
#include "formats/mitsuba/read_document.h"
#include "formats/mitsuba/world.h"

namespace pertev {

Scene read_mitsuba(const std::filesystem::path& path, const FileAccess& access, const ReadOptions& options,
                   Sink& sink) {
    return read_mitsuba(path, read_file(path), access, options, sink);
}

Scene read_mitsuba(const std::filesystem::path& path, std::span<const std::byte> text, const FileAccess& access,
                   const ReadOptions& options, Sink& sink) {
    TextureLoader loader(access, sink);
    loader.shrink_to(options.max_texture_size);
    mitsuba::Context context{
        .access = access, .options = options, .loader = loader, .sink = sink, .file = path.string()};
    mitsuba::Document document = mitsuba::read_document(path, text, context);
    mitsuba::World world(context, document.objects);
    return world.finish(document.bytes);
}

} // namespace pertev
