// Replaces the C library's allocation functions in a test program that preloads it. It counts the requested bytes and
// records the largest request.

#include <atomic>
#include <cerrno>
#include <cstddef>

extern "C" {

void* __libc_malloc(std::size_t);
void* __libc_calloc(std::size_t, std::size_t);
void* __libc_realloc(void*, std::size_t);
void* __libc_memalign(std::size_t, std::size_t);

std::atomic<std::size_t> allocated_bytes, largest_allocation;

static std::size_t counted(std::size_t bytes) {
    allocated_bytes += bytes;
    std::size_t largest = largest_allocation;
    while (largest < bytes && !largest_allocation.compare_exchange_weak(largest, bytes)) {
    }
    return bytes;
}

std::size_t allocated() { return allocated_bytes; }
std::size_t largest() { return largest_allocation.exchange(0); }

void* malloc(std::size_t bytes) { return __libc_malloc(counted(bytes)); }
void* calloc(std::size_t count, std::size_t each) {
    counted(count * each);
    return __libc_calloc(count, each);
}
void* realloc(void* memory, std::size_t bytes) { return __libc_realloc(memory, counted(bytes)); }
void* memalign(std::size_t alignment, std::size_t bytes) { return __libc_memalign(alignment, counted(bytes)); }
void* aligned_alloc(std::size_t alignment, std::size_t bytes) { return __libc_memalign(alignment, counted(bytes)); }
int posix_memalign(void** memory, std::size_t alignment, std::size_t bytes) {
    *memory = __libc_memalign(alignment, counted(bytes));
    return *memory != nullptr ? 0 : ENOMEM;
}
}
