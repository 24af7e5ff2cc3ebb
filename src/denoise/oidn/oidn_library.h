#pragma once

// The part of Open Image Denoise 2 that filters pictures, loaded at run time from wherever the system has it, so that
// it is not needed to build or start the program. The declarations are our own.
//
// Source: "Open Image Denoise API", openimagedenoise.org/documentation.html, sections "Devices" and "Filters".

#include <cstddef>
#include <memory>
#include <string>

namespace pertev {

class OidnLibrary {
public:
    // Values of OIDNDeviceType, OIDNFormat, OIDNQuality and OIDNError.
    static constexpr int kCpu = 1;
    static constexpr int kFloat3 = 3;
    static constexpr int kFastQuality = 4, kHighQuality = 6;
    static constexpr int kOutOfMemory = 4;

    /// Returns the library that $PERTEV_OIDN names, a file or its folder; else that of the system's loader, or that of
    /// the package pyoidn where look_in() finds it, beside this program, in the environment of the first `python3` of
    /// $PATH, or in the user's or the system's packages. Throws Error(BadInput) that names `setting` if no library
    /// fits. It is never unloaded.
    static std::shared_ptr<const OidnLibrary> find(const char* setting);

    /// Sets what asks the Python interpreter that has loaded this code for the folder of its pyoidn, which is empty if
    /// it has none; before any find(), which calls it on the finding thread.
    static void look_in(std::string (*folder_of_pyoidn)());

    /// Returns the library's version, such as "2.5.1".
    std::string version() const;

    // The functions of these names. Devices and filters are opaque.
    bool (*is_cuda_supported)(int index);
    void* (*new_device)(int type);
    void* (*new_cuda_device)(const int* indices, void* const* streams, int count);
    void (*set_device_bool)(void* device, const char* name, bool value);
    void (*set_device_int)(void* device, const char* name, int value);
    int (*device_int)(void* device, const char* name);
    int (*device_error)(void* device, const char** message);
    void (*commit_device)(void* device);
    void (*release_device)(void* device);
    void* (*new_filter)(void* device, const char* type);
    void (*set_shared_image)(void* filter, const char* name, void* memory, int format, std::size_t width,
                             std::size_t height, std::size_t offset, std::size_t pixel_bytes, std::size_t row_bytes);
    void (*set_filter_bool)(void* filter, const char* name, bool value);
    void (*set_filter_int)(void* filter, const char* name, int value);
    void (*commit_filter)(void* filter);
    void (*execute_filter)(void* filter); // in the order of the device's stream; waits for its end
    void (*release_filter)(void* filter);

private:
    std::string load(const std::string& file);

    int version_ = 0; // two decimal digits for each of three parts
};

} // namespace pertev
