#include "formats/file_access.h"

#include <algorithm>
#include <system_error>

#include <fmt/format.h>

#include "base/error.h"

namespace fs = std::filesystem;

namespace pertev {
namespace {

fs::path canonical_folder(const fs::path& folder, const std::string& what) {
    std::error_code ec;
    const fs::path canonical = fs::canonical(folder.empty() ? fs::path(".") : folder, ec);
    if (ec) throw Error(ErrorCode::BadInput, fmt::format("{}: {}: {}", folder.string(), what, ec.message()));
    return canonical;
}

/// By whole components: /scenes/a does not contain /scenes/ab.
bool is_within(const fs::path& path, const fs::path& root) {
    return std::mismatch(root.begin(), root.end(), path.begin(), path.end()).first == root.end();
}

} // namespace

FileAccess::FileAccess(const fs::path& scene_file, const std::vector<fs::path>& allowed) {
    roots_.push_back(canonical_folder(scene_file.parent_path(), "the scene's folder cannot be opened"));
    for (const fs::path& folder : allowed) {
        roots_.push_back(canonical_folder(folder, "the folder of --allow-path cannot be opened"));
    }
}

fs::path FileAccess::resolve(const fs::path& from, const std::string& reference) const {
    const auto refuse = [&](const std::string& why) {
        return Error(ErrorCode::BadInput, fmt::format("{}: refers to \"{}\", {}", from.string(), reference, why));
    };
    if (reference.empty()) throw refuse("which is no file name");
    // The system would cut the name there, after the check below has seen all of it.
    if (reference.find('\0') != std::string::npos) throw refuse("a name that holds a zero byte");
    std::string portable = reference;
    std::replace(portable.begin(), portable.end(), '\\', '/');

    std::error_code ec;
    const fs::path base = from.has_parent_path() ? from.parent_path() : fs::path(".");
    const fs::path path = fs::weakly_canonical(base / portable, ec);
    if (ec) throw refuse(fmt::format("which cannot be opened: {}", ec.message()));
    // What is left of a symbolic link after resolving leads nowhere yet; where it will lead is not known.
    if (fs::is_symlink(fs::symlink_status(path, ec))) throw refuse("a symbolic link that leads nowhere");
    if (std::none_of(roots_.begin(), roots_.end(), [&](const fs::path& root) { return is_within(path, root); })) {
        throw refuse(fmt::format("which is outside the scene's folder; if it is meant, allow it with --allow-path {}",
                                 path.parent_path().string()));
    }
    return path;
}

std::optional<fs::path> FileAccess::find(const fs::path& from, const std::string& reference) const {
    std::error_code ec;
    const fs::path path = resolve(from, reference);
    if (fs::exists(path, ec)) return path;
    if (path.filename().empty()) return std::nullopt;
    const fs::path beside = resolve(from, path.filename().string());
    if (fs::exists(beside, ec)) return beside;
    return std::nullopt;
}

} // namespace pertev
