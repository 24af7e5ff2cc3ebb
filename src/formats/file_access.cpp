#include "formats/file_access.h"

#include <algorithm>
#include <system_error>

#include <fmt/format.h>

#include "base/error.h"
#include "base/message_text.h"

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

Error refusal(const fs::path& from, const std::string& reference, const std::string& why) {
    return Error(ErrorCode::BadInput,
                 fmt::format("{}: refers to \"{}\", {}", from.string(), shortened(reference), why));
}

void check_is_name(const fs::path& from, const std::string& reference) {
    if (reference.empty()) throw refusal(from, reference, "which is no file name");
    // The system would cut the name there, after the checks have seen all of it.
    if (reference.find('\0') != std::string::npos) throw refusal(from, reference, "a name that holds a zero byte");
}

fs::path portable(std::string reference) {
    std::replace(reference.begin(), reference.end(), '\\', '/');
    return reference;
}

struct Located {
    bool is_there, is_allowed;
    fs::path path;
};

fs::path folder_of(const fs::path& from) { return from.has_parent_path() ? from.parent_path() : fs::path("."); }

} // namespace

FileAccess::FileAccess(const fs::path& scene_file, const std::vector<fs::path>& allowed) {
    roots_.push_back(canonical_folder(scene_file.parent_path(), "the scene's folder cannot be opened"));
    for (const fs::path& folder : allowed) {
        roots_.push_back(canonical_folder(folder, "the folder of --allow-path cannot be opened"));
    }
}

bool FileAccess::is_allowed(const fs::path& canonical) const {
    return std::any_of(roots_.begin(), roots_.end(), [&](const fs::path& root) { return is_within(canonical, root); });
}

fs::path FileAccess::resolve(const fs::path& from, const std::string& reference) const {
    check_is_name(from, reference);
    std::error_code ec;
    const fs::path path = fs::weakly_canonical(folder_of(from) / portable(reference), ec);
    if (ec) throw refusal(from, reference, fmt::format("which cannot be opened: {}", ec.message()));
    // What is left of a symbolic link after resolving leads nowhere yet; where it will lead is not known.
    if (fs::is_symlink(fs::symlink_status(path, ec))) {
        throw refusal(from, reference, "a symbolic link that leads nowhere");
    }
    if (!is_allowed(path)) {
        throw refusal(from, reference,
                      fmt::format("which is outside the scene's folder; if it is meant, allow it with --allow-path {}",
                                  path.parent_path().string()));
    }
    return path;
}

std::optional<fs::path> FileAccess::find(const fs::path& from, const std::string& reference, Messages& messages) const {
    check_is_name(from, reference);
    // A name longer than the system takes, for one, has no path: there is no such file.
    const auto located = [&](const fs::path& name) {
        std::error_code ec;
        const fs::path path = fs::weakly_canonical(folder_of(from) / name, ec);
        return Located{.is_there = !ec && fs::exists(path, ec), .is_allowed = is_allowed(path), .path = path};
    };
    const fs::path name = portable(reference);
    const Located wanted = located(name);
    if (wanted.is_there && wanted.is_allowed) return wanted.path;
    if (name.has_filename() && name.has_parent_path()) {
        const Located beside = located(name.filename());
        if (beside.is_there && beside.is_allowed) {
            if (!wanted.is_allowed) {
                messages.warn(fmt::format("{}: files named as in \"{}\", outside the scene's folder: those of the same "
                                          "name here are read",
                                          folder_of(from).string(), shortened(name.parent_path().string())));
            }
            return beside.path;
        }
    }
    if (wanted.is_there) (void)resolve(from, reference); // throws
    return std::nullopt;
}

} // namespace pertev
