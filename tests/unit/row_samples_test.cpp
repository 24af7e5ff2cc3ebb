// The samples that rows have depend on the set of parts alone, and a part that overlaps others adds nothing.

#include <set>
#include <utility>

#include <doctest/doctest.h>

#include "render/row_samples.h"
#include "tests/support/random.h"

using namespace pertev;

TEST_CASE("bands of rows hold the samples that were added, and refuse those that are there") {
    constexpr uint32_t kRows = 7, kSamples = 9;
    test::Random random(5);
    for (int round = 0; round < 200; ++round) {
        RowSamples samples(kRows);
        std::set<std::pair<uint32_t, uint32_t>> there; // row, sample
        for (int k = 0; k < 12; ++k) {
            FilmPart part = {random.below(kRows + 1),
                             random.below(kRows + 1),
                             {random.below(kSamples + 1), random.below(kSamples + 1)}};
            if (part.first_row > part.end_row) std::swap(part.first_row, part.end_row);
            if (part.samples.first > part.samples.end) std::swap(part.samples.first, part.samples.end);
            std::set<std::pair<uint32_t, uint32_t>> of_part;
            for (uint32_t row = part.first_row; row < part.end_row; ++row)
                for (uint32_t s = part.samples.first; s < part.samples.end; ++s) of_part.insert({row, s});
            bool is_free = true;
            for (const auto& one : of_part) is_free = is_free && !there.contains(one);
            REQUIRE(samples.add(part) == is_free);
            if (is_free) there.merge(of_part);
            std::set<std::pair<uint32_t, uint32_t>> held;
            uint32_t row = 0;
            for (const RowSamples::Band& band : samples.bands()) {
                REQUIRE(band.first_row == row);
                REQUIRE((band.first_row == 0 || band.ranges != (&band - 1)->ranges));
                for (; row < band.end_row; ++row) {
                    uint32_t end = 0;
                    for (const SampleRange& range : band.ranges) {
                        REQUIRE((range.first < range.end && (range.first > end || (range.first == 0 && end == 0))));
                        end = range.end;
                        for (uint32_t s = range.first; s < range.end; ++s) held.insert({row, s});
                    }
                }
            }
            REQUIRE(row == kRows);
            REQUIRE(held == there);
        }
        RowSamples again(kRows);
        const std::vector<FilmPart> parts = samples.parts();
        for (auto part = parts.rbegin(); part != parts.rend(); ++part) REQUIRE(again.add(*part));
        REQUIRE(again.parts() == parts);
    }
}

TEST_CASE("rows have a least and a most number of samples") {
    RowSamples samples(4);
    CHECK((samples.least() == 0 && samples.most() == 0));
    samples.add({0, 3, {2, 5}});
    CHECK((samples.least() == 0 && samples.most() == 3));
    samples.add({1, 4, {7, 8}});
    CHECK((samples.least() == 1 && samples.most() == 4));
    CHECK(samples.bands()[0].first_missing(9) == SampleRange{0, 2});
    CHECK(samples.bands()[0].first_missing(1) == SampleRange{0, 2});
    samples.add({0, 1, {0, 2}});
    CHECK(samples.bands()[0].first_missing(9) == SampleRange{5, 9});
    CHECK(samples.bands()[0].first_missing(5).count() == 0);
}
