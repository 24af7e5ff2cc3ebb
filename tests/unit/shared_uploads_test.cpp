// Arrays that one device has are copied from there to another, and only those that stay where they are on the host.

#include <doctest/doctest.h>

#include <numeric>
#include <vector>

#include "device/buffer.h"
#include "device/shared_uploads.h"
#include "tests/support/options.h"
#include "tests/support/render_scenes.h"

using namespace pertev;

TEST_CASE("an array that stays on the host is copied from the device that has it, until that forgets it") {
    constexpr std::size_t kCount = 3000;
    Queue first = test::requested_queue(), second = test::requested_queue();
    SharedUploads of_first(first), of_second(second);
    std::vector<uint32_t> host(kCount);
    std::iota(host.begin(), host.end(), 0u);
    const std::vector<uint32_t> before = host;
    const Buffer<uint32_t> there(first, kCount, "there"), here(second, kCount, "here");
    const auto upload_to_second = [&](const SharedUploads* from, bool lasts) {
        const SharedUploads::Scope scope(of_second, from);
        upload_array(second, here.data(), std::as_bytes(std::span(host)), lasts);
        return here.download();
    };
    of_first.lasts(std::as_bytes(std::span(host)));
    {
        const SharedUploads::Scope scope(of_first, nullptr);
        upload_array(first, there.data(), std::as_bytes(std::span(host)));
        first.wait();
    }
    for (uint32_t& number : host) number += 7; // shows where a copy comes from
    CHECK(upload_to_second(&of_first, true) == before);
    CHECK(upload_to_second(&of_first, false) == host); // another array may lie there by now
    CHECK(upload_to_second(nullptr, true) == host);
    of_second.lasts(std::as_bytes(std::span(host)));
    CHECK(upload_to_second(&of_first, false) == before);
    of_first.clear();
    CHECK(upload_to_second(&of_first, false) == host);
    upload_array(second, here.data(), std::as_bytes(std::span(before)), true); // without a scope
    CHECK(here.download() == before);
}
