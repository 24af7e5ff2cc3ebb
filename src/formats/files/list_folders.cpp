#include "formats/files/list_folders.h"

#include <algorithm>
#include <iterator>
#include <system_error>

namespace fs = std::filesystem;

namespace pertev {
namespace {

constexpr std::size_t kMaxEntries = 20000; // total for all folders
constexpr std::size_t kMaxLevels = 16;
constexpr std::size_t kMaxNamed = 20;

char lower(char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; }

std::string lower(std::string text) {
    std::ranges::transform(text, text.begin(), [](char c) { return lower(c); });
    return text;
}

bool is_same_but_for_case(const std::string& a, const std::string& b) {
    return std::ranges::equal(a, b, [](char x, char y) { return lower(x) == lower(y); });
}

bool is_below(const fs::path& path, const fs::path& folder) {
    return std::mismatch(folder.begin(), folder.end(), path.begin(), path.end()).first == folder.end();
}

std::size_t component_count(const fs::path& path) {
    return static_cast<std::size_t>(std::distance(path.begin(), path.end()));
}

/// The degree to which a file fits a name; the greatest is the best.
struct Fit {
    std::size_t components = 0; // number of last components that are those of the name
    bool is_direct = false;     // they are all there is below the folder
    bool is_same_case = false;  // same case in all of them
    auto operator<=>(const Fit&) const = default;
};

Fit fit_of(const fs::path& path, std::size_t folder_size, const std::vector<std::string>& name) {
    Fit fit{.components = 0, .is_direct = false, .is_same_case = true};
    auto component = path.end();
    const std::size_t below = component_count(path) - folder_size;
    while (fit.components < std::min(below, name.size())) {
        const std::string& here = (--component)->native();
        const std::string& wanted = name[name.size() - 1 - fit.components];
        if (!is_same_but_for_case(here, wanted)) break;
        fit.is_same_case = fit.is_same_case && here == wanted;
        ++fit.components;
    }
    fit.is_direct = fit.components == below;
    return fit;
}

} // namespace

std::vector<std::string> components_below(const fs::path& name) {
    std::vector<std::string> components;
    for (const fs::path& component : name.lexically_normal()) {
        const std::string& text = component.native();
        const bool is_drive = components.empty() && text.size() == 2 && text[1] == ':';
        if (text.empty() || text == "/" || text == "." || text == ".." || is_drive) continue;
        components.push_back(text);
    }
    return components;
}

void FolderListing::list_level(std::vector<fs::path>& level, std::size_t folder_size) {
    std::vector<fs::path> next;
    for (const fs::path& folder : level) {
        std::error_code fault;
        for (fs::directory_iterator at(folder, fault), end; !fault && at != end; at.increment(fault)) {
            if (entries_++ == kMaxEntries) return level.clear();
            if (at->path().filename().native().starts_with('.')) continue;
            std::error_code unknown; // a file whose kind is unknown is skipped
            if (at->is_directory(unknown) && !at->is_symlink(unknown)) next.push_back(at->path());
            if (at->is_regular_file(unknown)) files_.push_back({at->path(), folder_size});
        }
    }
    level = std::move(next);
}

void FolderListing::list() {
    for (const fs::path& folder : folders_) {
        std::vector<fs::path> level = {folder};
        for (std::size_t i = 0; i < kMaxLevels && !level.empty(); ++i) list_level(level, component_count(folder));
    }
    std::ranges::sort(files_, {}, &File::path); // folders may be nested, and have no natural order
    const auto same = [](const File& a, const File& b) { return a.path == b.path; };
    files_.erase(std::unique(files_.begin(), files_.end(), same), files_.end());
    for (std::size_t i = 0; i < files_.size(); ++i) {
        by_name_[lower(files_[i].path.filename().string())].push_back(i);
    }
}

std::vector<fs::path> FolderListing::best_fits(const fs::path& name, const fs::path& folder) {
    const std::vector<std::string> components = components_below(name);
    const std::lock_guard lock(mutex_);
    if (!is_listed_) list();
    is_listed_ = true;
    std::vector<fs::path> found;
    const auto named = components.empty() ? by_name_.end() : by_name_.find(lower(components.back()));
    if (named == by_name_.end()) return found;
    Fit best;
    for (const std::size_t number : named->second) {
        const File& file = files_[number];
        if (!folder.empty() && !is_below(file.path, folder)) continue;
        const Fit fit = fit_of(file.path, folder.empty() ? file.folder_size : component_count(folder), components);
        if (fit.components == 0 || fit < best) continue;
        if (best < fit) found.clear();
        best = fit;
        found.push_back(file.path);
    }
    return found;
}

bool FolderListing::may_name_another() {
    const std::lock_guard lock(mutex_);
    return named_++ < kMaxNamed;
}

} // namespace pertev
