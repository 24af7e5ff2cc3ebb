#include <stdexcept>

#include <doctest/doctest.h>

#include "device/buffer.h"

using namespace pertev;

TEST_CASE("a queue moves while it has given no memory; after that its buffers hold it where it is") {
    Queue queue = Queue::make_cpu();
    Queue moved(std::move(queue));
    {
        const Buffer<int> buffer(moved, 3, "numbers");
        CHECK_THROWS_AS(Queue(std::move(moved)), std::logic_error);
    }
}
