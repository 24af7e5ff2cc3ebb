#pragma once

// Restricts which files a scene may read: those below its own folder, and below each folder that the user allowed. A
// scene file from a stranger must not be able to read (and show in a picture) anything else.

#include <filesystem>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "base/sink.h"
#include "formats/files/list_folders.h"

namespace pertev {

class FileAccess {
public:
    /// `scene_file` is the file named by the user, `allowed` are further folders (`allow_path`).
    FileAccess(const std::filesystem::path& scene_file, const std::vector<std::filesystem::path>& allowed);

    /// Resolves `reference`, as written at `from` (a location in a file of the scene, to whose folder it is
    /// relative): symbolic links, `..` and backslashes. Throws Error(BadInput) that names `from` and `allow_path` if
    /// it leads outside. The file need not exist.
    std::filesystem::path resolve(const FileLocation& from, const std::string& reference) const;

    /// Finds the file that `reference` names, for reading. If that path is not readable, it searches below the folder
    /// of `from` or below allowed folders for the file whose path ends like `reference`, ignoring the case of A to Z,
    /// if a single file fits best, because exporters write paths of the machine on which they ran. A warning reports
    /// it. Returns nothing if no file fits, and with a warning if several do. Throws Error(BadInput), which names
    /// `allow_path`, if the only such file is outside.
    std::optional<std::filesystem::path> find(const FileLocation& from, const std::string& reference, Sink& sink) const;

    /// The files that find() has returned, in this order, each once.
    const std::vector<std::filesystem::path>& found() const { return found_->in_order; }

private:
    struct Found {
        std::vector<std::filesystem::path> in_order;
        std::set<std::filesystem::path> known;
    };

    struct Located {
        bool is_there, is_allowed;
        std::filesystem::path path;
    };
    bool is_allowed(const std::filesystem::path& canonical) const;
    Located locate(const std::filesystem::path& name) const;
    std::optional<std::filesystem::path> find_unlisted(const FileLocation& from, const std::string& reference,
                                                       Sink& sink) const;
    std::optional<std::filesystem::path> find_end_of(const std::filesystem::path& name, const FileLocation& from,
                                                     Sink& sink) const;

    std::vector<std::filesystem::path> roots_; // canonical
    std::shared_ptr<FolderListing> listing_;   // listing of roots_
    std::shared_ptr<Found> found_ = std::make_shared<Found>();
};

} // namespace pertev
