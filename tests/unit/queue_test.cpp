#include <stdexcept>
#include <thread>
#include <utility>

#include <doctest/doctest.h>

#include "base/parallel_for.h"
#include "device/buffer.h"
#include "device/launch.h"
#include "device/readback.h"
#include "device/wait_for_device.h"
#include "integrators/ray_tree/tree_stages.h"
#include "tests/support/device_stages.h"
#include "tests/support/render_scenes.h"

using namespace pertev;

TEST_CASE("a queue can be moved until it has allocated memory") {
    Queue queue = Queue::make_cpu();
    Queue moved(std::move(queue));
    {
        const Buffer<int> buffer(moved, 3, "numbers");
        CHECK_THROWS_AS(Queue(std::move(moved)), std::logic_error);
    }
}

TEST_CASE("a dry run counts the bytes of a device and allocates none") {
    const auto take = [](Queue& queue) {
        Buffer<Float4> grown(queue, 10, "numbers");
        grown.grow(queue, 5, "fewer");
        CHECK(grown.size() == 10);
        grown.grow(queue, 1000, "more");
        grown.fill(1);
        const std::vector<int> values(77, 3);
        const Buffer<int> uploaded(queue, std::span<const int>(values), "values");
        if (queue.is_dry_run()) CHECK(uploaded.download() == std::vector<int>(77));
        CHECK(uploaded.data() != nullptr);
        CHECK(static_cast<const void*>(uploaded.data()) != grown.data());
        return queue.allocated_bytes();
    };
    Queue cpu = Queue::make_cpu();
    for (const bool is_cuda : {false, true}) {
        Queue dry = Queue::make_dry_run(is_cuda);
        CHECK(dry.is_cuda() == is_cuda);
        CHECK(take(dry) == take(cpu));
        CHECK(dry.allocated_bytes() == 0);
        CHECK(dry.peak_bytes() == cpu.peak_bytes());
        const Buffer<std::byte> huge(dry, std::size_t(1) << 50, "more than any machine has");
        CHECK(dry.allocated_bytes() == std::size_t(1) << 50);
        launch(dry, "nothing", 1u << 31, BeginRounds{nullptr, 1}); // a dry run runs no stage
    }
}

TEST_CASE("a queue without a device has nothing to wait for") {
    wait_for_device(Queue::make_cpu());
    wait_for_device(Queue::make_dry_run(true));
}

TEST_CASE("streams run after the work before the fork, and work after the join runs after all streams") {
    Queue queue = test::requested_queue();
    constexpr int kStreams = Queue::kMaxStreams;
    constexpr std::size_t kMany = 1 << 22; // this fill takes longer than launching the next
    Buffer<unsigned char> sum(queue, kMany * kStreams, "bytes");
    sum.fill(7); // the stream's values remain, so it wrote later
    {
        const Queue::Fork fork(queue, kStreams);
        CHECK(queue.streams() == kStreams);
        for (int i = 0; i < kStreams; ++i) {
            const Queue::OnStream on(queue, i);
            CHECK(queue.stream_index() == i);
            queue.fill(sum.data() + static_cast<std::size_t>(i) * kMany, static_cast<unsigned char>(i + 1), kMany);
        }
        CHECK(queue.stream_index() == 0);
    }
    CHECK(queue.streams() == 1);
    const std::vector<unsigned char> there = sum.download();
    for (int i = 0; i < kStreams; ++i) {
        CHECK(there[static_cast<std::size_t>(i) * kMany] == i + 1);
        CHECK(there[static_cast<std::size_t>(i + 1) * kMany - 1] == i + 1);
    }
}

TEST_CASE("an exception on a stream leaves the queue with a single stream") {
    Queue queue = test::requested_queue();
    Buffer<unsigned char> bytes(queue, 100, "bytes");
    const auto fail_on_a_stream = [&] {
        const Queue::Fork fork(queue, Queue::kMaxStreams);
        const Queue::OnStream on(queue, 2);
        bytes.fill(3);
        throw std::runtime_error("on a stream");
    };
    CHECK_THROWS_AS(fail_on_a_stream(), std::runtime_error);
    CHECK(queue.streams() == 1);
    CHECK(queue.stream_index() == 0);
    CHECK(bytes.download()[99] == 3); // runs after the stream's earlier work
}

TEST_CASE("a number is read back as it was when requested, independent of later work") {
    Queue queue = test::requested_queue();
    Buffer<uint32_t> number(queue, 1, "number");
    Readback<uint32_t> readback(queue);
    for (const unsigned char value : {1, 2, 3}) {
        number.fill(value);
        readback.take(number.data());
        number.fill(0);
        CHECK(readback.wait() == 0x01010101u * value);
    }
}

TEST_CASE("a queue of the CPU keeps its own number of threads, whichever thread uses it") {
    const int own = thread_count();
    const auto counted_by = [](Queue& queue) {
        int count = 0;
        launch(queue, "count_threads", 1, test::CountThreads{&count});
        return count;
    };
    Queue any = Queue::make_cpu(), one = Queue::make_cpu(Threads(1)), three = Queue::make_cpu(Threads(3));
    CHECK(counted_by(any) == own);
    CHECK(counted_by(one) == 1);
    CHECK(counted_by(three) == 3);
    CHECK(thread_count() == own);
    {
        const UseThreads two(2);
        Queue of_caller = Queue::make_cpu();
        CHECK(thread_count() == 2);
        CHECK(counted_by(of_caller) == 2);
        CHECK(counted_by(three) == 3);
        CHECK(thread_count() == 2);
    }
    CHECK(thread_count() == own);
    Queue moved = std::move(three);
    int elsewhere = 0;
    std::thread([&] { elsewhere = counted_by(moved); }).join();
    CHECK(elsewhere == 3);
}
