#include "denoise/oidn/oidn_library.h"

#include <dlfcn.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <mutex>
#include <type_traits>
#include <vector>

#include <fmt/format.h>

#include "base/error.h"

namespace pertev {
namespace {

namespace fs = std::filesystem;

constexpr const char* kFile = "libOpenImageDenoise.so.2";
constexpr int kOldest = 20300, kTooNew = 30000; // versions that have the fast quality, and these functions

std::string environment(const char* name) {
    const char* const value = std::getenv(name);
    return value != nullptr ? value : "";
}

/// Adds the library in a folder of the package pyoidn, if it is there.
void add_library(const fs::path& pyoidn, std::vector<std::string>& files) {
    std::error_code fault;
    const fs::path file = pyoidn / "oidn/lib" / kFile;
    if (fs::exists(file, fault)) files.push_back(file.string());
}

/// Adds the library in the packages of each Python below `prefix`, the newest first.
void add_packages(const fs::path& prefix, std::vector<std::string>& files) {
    std::vector<std::string> found;
    std::error_code fault;
    for (fs::directory_iterator at(prefix / "lib", fault), end; !fault && at != end; at.increment(fault)) {
        if (!at->path().filename().string().starts_with("python3")) continue;
        for (const char* const packages : {"site-packages", "dist-packages"}) {
            add_library(at->path() / packages / "pyoidn", found);
        }
    }
    std::ranges::sort(found, std::greater<>());
    files.insert(files.end(), found.begin(), found.end());
}

/// Returns the file of this code: the program, or the Python module, beside which its package manager has put others.
fs::path own_file() {
    std::error_code fault;
    Dl_info info{};
    if (::dladdr(reinterpret_cast<const void*>(&own_file), &info) != 0 && info.dli_fname != nullptr &&
        info.dli_fname[0] == '/') {
        return fs::weakly_canonical(info.dli_fname, fault);
    }
    return fs::read_symlink("/proc/self/exe", fault);
}

/// Returns the prefix of the environment that the first `python3` of $PATH belongs to. The link in a virtual
/// environment is not followed, because its packages lie beside it.
fs::path prefix_of_python() {
    const std::string path = environment("PATH");
    for (std::size_t at = 0; at <= path.size();) {
        const std::size_t end = std::min(path.find(':', at), path.size());
        const fs::path folder = path.substr(at, end - at);
        std::error_code fault;
        if (folder.is_absolute() && fs::exists(folder / "python3", fault)) return folder.parent_path();
        at = end + 1;
    }
    return {};
}

std::string (*folder_by_interpreter)() = nullptr;

/// Returns the files to try, in order. A name without a folder is for the system's loader.
std::vector<std::string> files_to_try(const std::string& given) {
    if (!given.empty()) {
        std::error_code fault;
        if (!fs::is_directory(given, fault)) return {given};
        const fs::path below = fs::path(given) / "lib" / kFile;
        return {fs::exists(below, fault) ? below.string() : (fs::path(given) / kFile).string()};
    }
    std::vector<std::string> files = {kFile};
    if (folder_by_interpreter != nullptr) add_library(folder_by_interpreter(), files);
    for (fs::path folder = own_file().parent_path(); folder.has_relative_path(); folder = folder.parent_path()) {
        add_library(folder / "pyoidn", files);
        add_packages(folder, files);
    }
    for (const fs::path& prefix :
         {fs::path(environment("VIRTUAL_ENV")), prefix_of_python(), fs::path(environment("HOME")) / ".local",
          fs::path("/usr/local"), fs::path("/usr")}) {
        if (prefix.is_absolute()) add_packages(prefix, files);
    }
    return files;
}

} // namespace

/// Loads `file`. Returns why the file cannot be used; empty if it can.
std::string OidnLibrary::load(const std::string& file) {
    void* const library = ::dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL | RTLD_NODELETE);
    if (library == nullptr) return ::dlerror();
    const char* missing = nullptr;
    const auto find_one = [&](const char* name, auto& function) {
        function = reinterpret_cast<std::remove_reference_t<decltype(function)>>(::dlsym(library, name));
        if (function == nullptr && missing == nullptr) missing = name;
    };
    find_one("oidnIsCUDADeviceSupported", is_cuda_supported);
    find_one("oidnNewDevice", new_device);
    find_one("oidnNewCUDADevice", new_cuda_device);
    find_one("oidnSetDeviceBool", set_device_bool);
    find_one("oidnSetDeviceInt", set_device_int);
    find_one("oidnGetDeviceInt", device_int);
    find_one("oidnGetDeviceError", device_error);
    find_one("oidnCommitDevice", commit_device);
    find_one("oidnReleaseDevice", release_device);
    find_one("oidnNewFilter", new_filter);
    find_one("oidnSetSharedFilterImage", set_shared_image);
    find_one("oidnSetFilterBool", set_filter_bool);
    find_one("oidnSetFilterInt", set_filter_int);
    find_one("oidnCommitFilter", commit_filter);
    find_one("oidnExecuteFilter", execute_filter);
    find_one("oidnReleaseFilter", release_filter);
    std::string why;
    if (missing != nullptr) {
        why = fmt::format("{} lacks the function {}", file, missing);
    } else if (void* const device = new_device(kCpu)) {
        version_ = device_int(device, "version");
        release_device(device);
        if (version_ < kOldest || version_ >= kTooNew) {
            why = fmt::format("{} has version {}; expected version 2.3 or a later version 2", file, version());
        }
    } else {
        const char* message = nullptr;
        device_error(nullptr, &message);
        why = fmt::format("{}: {}", file, message != nullptr ? message : "the library supports no device of this CPU");
    }
    ::dlclose(library);
    return why;
}

void OidnLibrary::look_in(std::string (*folder_of_pyoidn)()) { folder_by_interpreter = folder_of_pyoidn; }

std::string OidnLibrary::version() const {
    return fmt::format("{}.{}.{}", version_ / 10000, version_ / 100 % 100, version_ % 100);
}

std::shared_ptr<const OidnLibrary> OidnLibrary::find(const char* setting) {
    static std::mutex mutex;
    static std::shared_ptr<const OidnLibrary> found; // by the last search that found one
    static std::string found_by;
    const std::string given = environment("PERTEV_OIDN");
    const auto is_found = [&] { return found && given == found_by; };
    if (const std::scoped_lock lock(mutex); is_found()) return found;
    // The search takes the interpreter's lock, whose holder may wait for the mutex, so it comes first.
    const std::vector<std::string> files = files_to_try(given);
    const std::scoped_lock lock(mutex);
    if (is_found()) return found;
    std::string why;
    for (const std::string& file : files) {
        OidnLibrary library;
        const std::string fault = library.load(file);
        if (fault.empty()) {
            found_by = given;
            return found = std::make_shared<const OidnLibrary>(library);
        }
        if (why.empty() || file != kFile) why = fault;
    }
    throw Error(ErrorCode::BadInput, setting, "oidn",
                given.empty() ? fmt::format("Open Image Denoise was not found: `pip install pyoidn` installs it, and "
                                            "PERTEV_OIDN can name another copy ({})",
                                            why)
                              : fmt::format("PERTEV_OIDN={}: {}; `pip install pyoidn` installs a supported library, "
                                            "which is found without PERTEV_OIDN",
                                            given, why));
}

} // namespace pertev
