// The fibers of lanes, the random scheduler, and warp operations. A lane that waits switches directly to another lane.
// Only ended lanes and faults return to run_warps(). ucontext would be sufficient, but the two system calls of a
// switch cost more than the lanes' work.

#include "tests/support/emulated_warp.h"

#include <immintrin.h>
#include <sys/mman.h>

#include <algorithm>
#include <cstdlib>
#include <memory>
#include <utility>
#include <vector>

#include "tests/support/emulated_lanes.h"
#include "tests/support/random.h"

#if defined(__SANITIZE_ADDRESS__)
#include <sanitizer/asan_interface.h>
#include <sanitizer/common_interface_defs.h>
#endif

namespace pertev::test {

namespace lane {
Index thread_index, block_index, block_size;
}

namespace {

using lane::CodeLocation;

constexpr std::size_t kStackBytes = 128 << 10, kGuardBytes = 4 << 10;
constexpr uint32_t kMaxWarps = 8; // at once

#if defined(__SANITIZE_ADDRESS__)
/// Announces a switch from the running fiber to `to` to the sanitizer. `kept` receives the fake stack of the running
/// fiber; null if it never resumes.
void about_to_go(void** kept, const Fiber& to) { __sanitizer_start_switch_fiber(kept, to.stack, to.stack_bytes); }
/// Reports to the sanitizer that the switch is complete. The first fiber comes from `main`, whose stack is recorded
/// then.
void came_from(void* kept, Fiber& main) {
    const void* bottom;
    std::size_t bytes;
    __sanitizer_finish_switch_fiber(kept, &bottom, &bytes);
    if (main.stack == nullptr)
        main.stack = const_cast<char*>(static_cast<const char*>(bottom)), main.stack_bytes = bytes;
}
/// A lane never returns from its first function, so frames of its last run are still marked.
void forget_frames(const Fiber& fiber) { __asan_unpoison_memory_region(fiber.stack, fiber.stack_bytes); }
#else
void about_to_go(void**, const Fiber&) {}
void came_from(void*, Fiber&) {}
void forget_frames(const Fiber&) {}
#endif

/// Saves the caller's state and resumes another one's.
[[gnu::naked, gnu::noinline]] void switch_stack(void** /*save*/, void* /*to*/) {
    asm("pushq %rbp\n pushq %rbx\n pushq %r12\n pushq %r13\n pushq %r14\n pushq %r15\n"
        "movq %rsp, (%rdi)\n movq %rsi, %rsp\n"
        "popq %r15\n popq %r14\n popq %r13\n popq %r12\n popq %rbx\n popq %rbp\n ret");
}

class Machine {
public:
    Machine();
    std::string run(const EmulatedLaunch& launch, const std::function<void()>& kernel);
    uint64_t wait_for_lanes(const WarpOperation& operation);
    uint32_t wait_for_active_mask(const WarpOperation& operation);
    void step();
    bool is_running() const { return lane_ != nullptr; }

private:
    static void lane_main();
    void start_warp(EmulatedWarp& warp);
    void switch_to(EmulatedLane& lane);
    void leave_lane(bool for_good);
    void go_on();
    EmulatedLane* choose_lane();
    void answer_active_mask(EmulatedWarp& warp);
    void perform(EmulatedWarp& warp, uint32_t mask);
    void fail(std::string what);
    bool chance(uint32_t of_256) { return (random_.bits() >> 24) < of_256; }

    std::vector<std::unique_ptr<EmulatedWarp>> slots_;
    std::vector<EmulatedWarp*> warps_; // number of lanes that have not ended
    std::vector<uint32_t> to_come_;    // indices of warps, the next one last
    EmulatedLaunch launch_;
    const std::function<void()>* kernel_ = nullptr;
    Random random_{0};
    uint32_t roam_ = 0, hurry_ = 0, partly_ = 0; // probabilities out of 256: to switch the warp, to answer
                                                 // __activemask at once, to answer with a part
    uint64_t steps_ = 0;
    EmulatedWarp* warp_ = nullptr; // who runs
    EmulatedLane* lane_ = nullptr;
    Fiber main_ = {};
    std::string fault_;
};

Machine& machine() {
    static Machine the_machine;
    return the_machine;
}

Machine::Machine() {
    const std::size_t bytes = kMaxWarps * 32 * kStackBytes;
    void* memory = ::mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
    if (memory == MAP_FAILED) std::abort();
    char* stack = static_cast<char*>(memory);
    for (uint32_t i = 0; i < kMaxWarps; ++i) {
        slots_.push_back(std::make_unique<EmulatedWarp>());
        for (EmulatedLane& lane : slots_.back()->lanes) {
            ::mprotect(stack, kGuardBytes, PROT_NONE);
            lane.fiber.stack = stack + kGuardBytes;
            lane.fiber.stack_bytes = kStackBytes - kGuardBytes;
            stack += kStackBytes;
        }
    }
}

// ---- who runs

void Machine::lane_main() {
    Machine& m = machine();
    came_from(nullptr, m.main_);
    (*m.kernel_)();
    const uint32_t me = 1u << (lane::thread_index.x & 31u);
    m.warp_->live &= ~me;
    m.warp_->ready &= ~me;
    m.leave_lane(true);
}

/// Starts the next warp in the slot of an ended one.
void Machine::start_warp(EmulatedWarp& warp) {
    const uint32_t warps_a_block = launch_.threads / 32;
    warp.block = to_come_.back() / warps_a_block;
    warp.first_thread = to_come_.back() % warps_a_block * 32;
    to_come_.pop_back();
    warp.live = warp.ready = 0xffffffffu;
    warp.waiting = warp.pending = 0;
    for (EmulatedLane& lane : warp.lanes) {
        forget_frames(lane.fiber);
        void** top = reinterpret_cast<void**>(lane.fiber.stack + lane.fiber.stack_bytes) - 8;
        std::fill_n(top, 8, nullptr); // six registers, the start address, and the end of the chain of frames
        top[6] = reinterpret_cast<void*>(&Machine::lane_main);
        lane.fiber.stack_pointer = top;
    }
    warps_.push_back(&warp);
}

/// Switches from the running fiber to a lane.
void Machine::switch_to(EmulatedLane& to) {
    Fiber& from = lane_ == nullptr ? main_ : lane_->fiber;
    lane_ = &to;
    lane::thread_index.x = warp_->first_thread + static_cast<uint32_t>(&to - warp_->lanes.data());
    lane::block_index.x = warp_->block;
    about_to_go(&from.fake_stack, to.fiber);
    switch_stack(&from.stack_pointer, to.fiber.stack_pointer);
    came_from(from.fake_stack, main_);
}

/// Switches from a lane back to run().
void Machine::leave_lane(bool for_good) {
    Fiber& from = lane_->fiber;
    about_to_go(for_good ? nullptr : &from.fake_stack, main_);
    switch_stack(&from.stack_pointer, main_.stack_pointer);
    std::abort(); // no warp continues this lane
}

/// Resumes a random lane, possibly the running one. Returns when the caller resumes.
void Machine::go_on() {
    EmulatedLane* next = choose_lane();
    if (next == nullptr) return leave_lane(false);
    if (next != lane_) switch_to(*next);
}

/// Does nothing after a fault.
EmulatedLane* Machine::choose_lane() {
    if (++steps_ > launch_.max_steps) fail("no end after " + std::to_string(launch_.max_steps) + " steps");
    if (!fault_.empty()) return nullptr;
    // Only a warp's own lanes can let it continue, so a warp that cannot continue never will.
    if (warp_ != nullptr && warp_->live != 0 && (warp_->ready | warp_->pending) == 0) {
        fail("no lane can go on");
        return nullptr;
    }
    if (warp_ == nullptr || warp_->live == 0 || chance(roam_)) {
        warp_ = warps_[random_.below(static_cast<uint32_t>(warps_.size()))];
    }
    if (warp_->ready == 0 || (warp_->pending != 0 && chance(hurry_))) answer_active_mask(*warp_);
    const uint32_t ready = warp_->ready, rank = random_.below(static_cast<uint32_t>(__builtin_popcount(ready)));
    return &warp_->lanes[static_cast<unsigned>(__builtin_ctz(_pdep_u32(1u << rank, ready)))];
}

std::string Machine::run(const EmulatedLaunch& launch, const std::function<void()>& kernel) {
    launch_ = launch;
    kernel_ = &kernel;
    random_ = Random(launch.seed);
    const auto one_of = [&](std::initializer_list<uint32_t> values) {
        return values.begin()[random_.below(static_cast<uint32_t>(values.size()))];
    };
    roam_ = one_of({0, 16, 256});
    hurry_ = one_of({0, 0, 16, 256});
    partly_ = one_of({0, 0, 64, 256});
    lane::block_size.x = launch.threads;
    for (uint32_t w = 0; w < launch.blocks * (launch.threads / 32); ++w) {
        to_come_.push_back(w);
        std::swap(to_come_.back(), to_come_[random_.below(w + 1)]); // in random order
    }
    const std::size_t at_once = one_of({1, 2, 3, 5, kMaxWarps});
    for (std::size_t i = 0; i < at_once && !to_come_.empty(); ++i) start_warp(*slots_[i]);
    while (!warps_.empty()) {
        if (EmulatedLane* next = choose_lane()) switch_to(*next);
        lane_ = nullptr;
        if (!fault_.empty()) break;
        if (warp_->live != 0) continue;
        std::erase(warps_, warp_);
        if (!to_come_.empty()) start_warp(*warp_);
    }
    if (!fault_.empty()) {
        for (const EmulatedWarp* warp : warps_)
            fault_ += warp == warp_ || steps_ > launch_.max_steps ? describe(*warp) : "";
    }
    warps_.clear();
    to_come_.clear();
    warp_ = nullptr;
    steps_ = 0;
    return std::exchange(fault_, {});
}

// ---- warp operations

void Machine::fail(std::string what) {
    if (fault_.empty()) fault_ = std::move(what);
}

void Machine::step() { go_on(); }

uint64_t Machine::wait_for_lanes(const WarpOperation& operation) {
    EmulatedWarp& warp = *warp_;
    EmulatedLane& lane = *lane_;
    const uint32_t me = 1u << (lane::thread_index.x & 31u);
    lane.operation = operation;
    if ((operation.mask & me) == 0) fail("a lane names a mask without itself");
    if (operation.kind == WarpOperationKind::Shuffle && (operation.mask >> operation.source & 1) == 0) {
        fail("a lane asks for the value of one that its mask does not name");
    }
    warp.ready &= ~me;
    warp.waiting |= me;
    if ((warp.waiting & operation.mask) == operation.mask) {
        bool agreed = true;
        for_each_lane(operation.mask, [&](unsigned k) {
            const WarpOperation& other = warp.lanes[k].operation;
            agreed &= other.kind == operation.kind && other.mask == operation.mask;
        });
        if (agreed) perform(warp, operation.mask);
    }
    go_on();
    return lane.result;
}

/// All lanes of `mask` have arrived.
void Machine::perform(EmulatedWarp& warp, uint32_t mask) {
    uint32_t yes = 0;
    for_each_lane(mask, [&](unsigned k) { yes |= warp.lanes[k].operation.value != 0 ? 1u << k : 0; });
    for_each_lane(mask, [&](unsigned k) {
        EmulatedLane& lane = warp.lanes[k];
        switch (lane.operation.kind) {
        case WarpOperationKind::Ballot:
            lane.result = yes;
            break;
        case WarpOperationKind::All:
            lane.result = yes == mask ? 1 : 0;
            break;
        case WarpOperationKind::Shuffle:
            lane.result = warp.lanes[static_cast<unsigned>(lane.operation.source)].operation.value;
            break;
        case WarpOperationKind::MatchAny:
            lane.result = 0;
            for_each_lane(mask, [&](unsigned j) {
                lane.result |= warp.lanes[j].operation.value == lane.operation.value ? 1u << j : 0;
            });
            break;
        case WarpOperationKind::Sync:
        case WarpOperationKind::ActiveMask:
            break;
        }
    });
    warp.waiting &= ~mask;
    warp.ready |= mask;
}

uint32_t Machine::wait_for_active_mask(const WarpOperation& operation) {
    EmulatedLane& lane = *lane_;
    lane.operation = operation;
    // One source line may be called from two places, so the call stack distinguishes them.
    for_each_call(lane, [&](const void* address) {
        lane.operation.value = (lane.operation.value ^ reinterpret_cast<uint64_t>(address)) * 0x9e3779b97f4a7c15u;
    });
    const uint32_t me = 1u << (lane::thread_index.x & 31u);
    warp_->ready &= ~me;
    warp_->pending |= me;
    go_on();
    return static_cast<uint32_t>(lane.result);
}

/// Returns the active mask to lanes that wait at the same call.
void Machine::answer_active_mask(EmulatedWarp& warp) {
    const uint32_t rank = random_.below(static_cast<uint32_t>(__builtin_popcount(warp.pending)));
    const uint32_t first = _pdep_u32(1u << rank, warp.pending);
    const uint64_t site = warp.lanes[static_cast<unsigned>(__builtin_ctz(first))].operation.value;
    uint32_t together = 0;
    for_each_lane(warp.pending, [&](unsigned k) { together |= warp.lanes[k].operation.value == site ? 1u << k : 0; });
    if (chance(partly_)) together &= random_.bits() | first;
    for_each_lane(together, [&](unsigned k) { warp.lanes[k].result = together; });
    warp.pending &= ~together;
    warp.ready |= together;
}

uint64_t wait_for_lanes(WarpOperationKind kind, uint32_t mask, uint64_t value, int source, const CodeLocation& at,
                        void* frame) {
    if (!machine().is_running()) std::abort(); // no lane is calling
    const WarpOperation operation = {kind, mask, value, source, at, static_cast<void* const*>(frame)};
    return kind == WarpOperationKind::ActiveMask ? machine().wait_for_active_mask(operation)
                                                 : machine().wait_for_lanes(operation);
}

} // namespace

std::string run_warps(const EmulatedLaunch& launch, const std::function<void()>& kernel) {
    return machine().run(launch, kernel);
}

namespace lane {

// Each function is a separate call, whose frame contains the caller's address.
[[gnu::noinline]] uint32_t active_mask(CodeLocation at) {
    return static_cast<uint32_t>(
        wait_for_lanes(WarpOperationKind::ActiveMask, 0, 0, 0, at, __builtin_frame_address(0)));
}
[[gnu::noinline]] uint32_t ballot(uint32_t mask, bool mine, CodeLocation at) {
    return static_cast<uint32_t>(
        wait_for_lanes(WarpOperationKind::Ballot, mask, mine ? 1 : 0, 0, at, __builtin_frame_address(0)));
}
[[gnu::noinline]] bool all(uint32_t mask, bool mine, CodeLocation at) {
    return wait_for_lanes(WarpOperationKind::All, mask, mine ? 1 : 0, 0, at, __builtin_frame_address(0)) != 0;
}
[[gnu::noinline]] uint32_t match_any(uint32_t mask, uint64_t key, CodeLocation at) {
    return static_cast<uint32_t>(
        wait_for_lanes(WarpOperationKind::MatchAny, mask, key, 0, at, __builtin_frame_address(0)));
}
[[gnu::noinline]] uint32_t shuffle(uint32_t mask, uint32_t value, int source, CodeLocation at) {
    return static_cast<uint32_t>(
        wait_for_lanes(WarpOperationKind::Shuffle, mask, value, source & 31, at, __builtin_frame_address(0)));
}
[[gnu::noinline]] void sync(uint32_t mask, CodeLocation at) {
    wait_for_lanes(WarpOperationKind::Sync, mask, 0, 0, at, __builtin_frame_address(0));
}
void step() { machine().step(); }

} // namespace lane

} // namespace pertev::test
