#include "formats/pbrt/read_pbrt.h"

#include "formats/files/gunzip.h"
#include "formats/files/load_textures.h"
#include "formats/pbrt/statements.h"
#include "formats/pbrt/world.h"

namespace pertev {
namespace {

/// Returns whether the last word of a text is WorldEnd, which pbrt-v4 does not have.
bool ends_with_world_end(std::string_view text) {
    constexpr std::string_view kWord = "WorldEnd";
    const std::size_t at = text.rfind(kWord);
    if (at == std::string_view::npos) return false;
    const std::size_t line = text.rfind('\n', at) + 1; // 0 without one
    if (text.substr(line, at - line).find('#') != std::string_view::npos) return false;
    pbrt::Tokens rest(text.substr(at + kWord.size()));
    return rest.peek().kind == pbrt::TokenKind::End;
}

/// Reads a scene from the text of a file that has `file_bytes` bytes.
Scene read_text(const std::filesystem::path& path, std::span<const std::byte> bytes, uint64_t file_bytes,
                const FileAccess& access, const ReadOptions& options, Sink& sink) {
    const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    TextureLoader loader(access, sink);
    loader.shrink_to(options.max_texture_size);
    const pbrt::Context context{.access = access,
                                .options = options,
                                .loader = loader,
                                .sink = sink,
                                .file = path.string(),
                                .is_version_3 = ends_with_world_end(text)};
    pbrt::World world(context);
    pbrt::Statements statements(context, world);
    statements.read(text, path, file_bytes);
    return world.finish(statements.bytes());
}

} // namespace

Scene read_pbrt(const std::filesystem::path& path, const FileAccess& access, const ReadOptions& options, Sink& sink) {
    const UnzippedFile file = read_unzipped(path);
    return read_text(path, file.bytes, file.size, access, options, sink);
}

Scene read_pbrt(const std::filesystem::path& path, std::span<const std::byte> bytes, const FileAccess& access,
                const ReadOptions& options, Sink& sink) {
    return read_text(path, bytes, bytes.size(), access, options, sink);
}

} // namespace pertev
