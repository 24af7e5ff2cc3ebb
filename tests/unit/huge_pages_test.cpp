// Huge pages change no byte and no address.

#include <doctest/doctest.h>

#include <cstdint>
#include <vector>

#include "base/huge_pages.h"

using namespace pertev;

TEST_CASE("an array on huge pages is as any other") {
    for (const std::size_t count : {std::size_t(0), std::size_t(1), std::size_t(3) << 20}) {
        const auto values = array_on_huge_pages<uint32_t>(count);
        CHECK(values == std::vector<uint32_t>(count));
    }
}

TEST_CASE("memory moved into huge pages keeps its bytes at any size") {
    for (const std::size_t count : {std::size_t(0), std::size_t(1), std::size_t(1) << 18, std::size_t(3) << 20}) {
        CAPTURE(count);
        std::vector<uint32_t> values(count);
        for (std::size_t i = 0; i < count; ++i) values[i] = static_cast<uint32_t>(i) * 2654435761u;
        const uint32_t* const before = values.data();
        use_huge_pages(std::as_bytes(std::span(values)));
        CHECK(values.data() == before);
        uint64_t wrong = 0;
        for (std::size_t i = 0; i < count; ++i) wrong += values[i] != static_cast<uint32_t>(i) * 2654435761u ? 1 : 0;
        CHECK(wrong == 0);
        if (count > 0) values.back() = 7; // still writable
    }
}
