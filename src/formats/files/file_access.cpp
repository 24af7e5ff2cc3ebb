#include "formats/files/file_access.h"

#include <algorithm>
#include <system_error>

#include <fmt/format.h>

#include "base/error.h"
#include "base/message_text.h"

namespace fs = std::filesystem;

namespace pertev {
namespace {

fs::path canonical_folder(const fs::path& folder, const char* setting) {
    std::error_code ec;
    const fs::path canonical = fs::canonical(folder.empty() ? fs::path(".") : folder, ec);
    if (ec) throw Error(ErrorCode::BadInput, setting, folder.string(), "the folder cannot be opened: " + ec.message());
    if (!fs::is_directory(canonical, ec))
        throw Error(ErrorCode::BadInput, setting, folder.string(), "the path is not a folder");
    return canonical;
}

/// Returns whether `path` is `root` or below it. Whole components are compared: /scenes/a does not contain /scenes/ab.
bool is_within(const fs::path& path, const fs::path& root) {
    return std::mismatch(root.begin(), root.end(), path.begin(), path.end()).first == root.end();
}

Error refusal(const FileLocation& from, const std::string& reference, const std::string& why) {
    return Error(ErrorCode::BadInput, from, fmt::format("refers to \"{}\", {}", shortened(reference), why));
}

void check_is_name(const FileLocation& from, const std::string& reference) {
    if (reference.empty()) throw refusal(from, reference, "which is not a file name");
    // The system would cut the name there, after the checks have seen all of it.
    if (reference.find('\0') != std::string::npos) throw refusal(from, reference, "a name that holds a zero byte");
}

fs::path portable_path(std::string reference) {
    std::replace(reference.begin(), reference.end(), '\\', '/');
    return reference;
}

fs::path folder_of(const FileLocation& from) {
    const fs::path folder = fs::path(from.file).parent_path();
    return folder.empty() ? fs::path(".") : folder;
}

} // namespace

FileAccess::FileAccess(const fs::path& scene_file, const std::vector<fs::path>& allowed) {
    roots_.push_back(canonical_folder(scene_file.parent_path(), "scene"));
    for (const fs::path& folder : allowed) {
        roots_.push_back(canonical_folder(folder, "allow_path"));
    }
    listing_ = std::make_shared<FolderListing>(roots_);
}

bool FileAccess::is_allowed(const fs::path& canonical) const {
    return std::any_of(roots_.begin(), roots_.end(), [&](const fs::path& root) { return is_within(canonical, root); });
}

fs::path FileAccess::resolve(const FileLocation& from, const std::string& reference) const {
    check_is_name(from, reference);
    std::error_code ec;
    const fs::path path = fs::weakly_canonical(folder_of(from) / portable_path(reference), ec);
    if (ec) throw refusal(from, reference, fmt::format("which cannot be opened: {}", ec.message()));
    // A symbolic link that remains after resolving is dangling; its future target is unknown.
    if (fs::is_symlink(fs::symlink_status(path, ec))) {
        throw refusal(from, reference, "a broken symbolic link");
    }
    if (!is_allowed(path)) {
        throw refusal(from, reference,
                      fmt::format("which is outside the scene's folder; to allow it, set `allow_path={}`",
                                  path.parent_path().string()));
    }
    return path;
}

/// Finds the canonical path of a name and whether it is readable. A name without a path, such as one longer than the
/// system allows, is no file.
FileAccess::Located FileAccess::locate(const fs::path& name) const {
    std::error_code ec;
    const fs::path path = fs::weakly_canonical(name, ec);
    return {.is_there = !ec && fs::exists(path, ec), .is_allowed = is_allowed(path), .path = path};
}

/// Returns the file whose path ends like `name`; nothing, with a warning, if several do.
std::optional<fs::path> FileAccess::find_end_of(const fs::path& name, const FileLocation& from, Sink& sink) const {
    const std::vector<std::string> components = components_below(name);
    if (components.empty()) return std::nullopt;
    // Names in the same case below the folder itself are found without a search.
    for (std::size_t first = 0; first < components.size(); ++first) {
        fs::path end = folder_of(from);
        for (std::size_t i = first; i < components.size(); ++i) end /= components[i];
        const Located there = locate(end);
        if (there.is_there && there.is_allowed) return there.path;
    }
    const Located folder = locate(folder_of(from));
    for (const fs::path& below : {folder.is_allowed ? folder.path : fs::path(), fs::path()}) {
        std::vector<fs::path> fits;
        for (const fs::path& file : listing_->best_fits(name, below)) {
            const Located there = locate(file);
            if (there.is_there && there.is_allowed) fits.push_back(there.path);
        }
        if (fits.size() == 1) return fits.front();
        if (fits.empty()) continue;
        sink.warn({from, fmt::format("there is no \"{}\", and {} files match, such as {} and {}; none is read",
                                     shortened(name.string()), fits.size(), fits[0].string(), fits[1].string())});
        return std::nullopt;
    }
    return std::nullopt;
}

std::optional<fs::path> FileAccess::find(const FileLocation& from, const std::string& reference, Sink& sink) const {
    const std::optional<fs::path> file = find_unlisted(from, reference, sink);
    if (file && found_->known.insert(*file).second) found_->in_order.push_back(*file);
    return file;
}

std::optional<fs::path> FileAccess::find_unlisted(const FileLocation& from, const std::string& reference,
                                                  Sink& sink) const {
    check_is_name(from, reference);
    const fs::path name = portable_path(reference);
    const Located wanted = locate(folder_of(from) / name);
    if (wanted.is_there && wanted.is_allowed) return wanted.path;
    const std::optional<fs::path> found = find_end_of(name, from, sink);
    if (!found) {
        if (wanted.is_there) (void)resolve(from, reference); // throws
        return std::nullopt;
    }
    const std::string folder = folder_of(from).string();
    const bool is_same_name = found->filename() == name.filename();
    if (is_same_name && name.has_parent_path()) {
        const fs::path there = found->parent_path().lexically_relative(locate(folder_of(from)).path);
        sink.warn({FileLocation{folder},
                   fmt::format("files named as in \"{}\" are {}; files of the same name in {} are read instead",
                               shortened(name.parent_path().string()),
                               wanted.is_allowed ? "missing" : "outside the scene's folder",
                               there == "." ? "the folder itself" : "\"" + there.string() + "\"")});
    } else if (listing_->may_name_another()) {
        sink.warn(
            {from, fmt::format("there is no \"{}\"; {} is read instead, the only file of that name{}",
                               shortened(reference), found->string(), is_same_name ? "" : " except for its case")});
    } else {
        sink.warn({FileLocation{folder},
                   "further missing files are read from the only file of that name except for its case"});
    }
    return found;
}

} // namespace pertev
