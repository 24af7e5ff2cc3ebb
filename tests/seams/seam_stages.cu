#include "device/launch_body.h"
#include "tests/seams/absorbing_block.h"
#include "tests/seams/path_rounds_body.h"
#include "tests/seams/ranked_coverage.h"
#include "tests/seams/two_node_tree.h"

namespace pertev {
template class test::PathRounds<kPlainDiffuse, FilmListeners>;
template class test::PathRounds<kPlainDiffuse | test::kTwoNodeTree, FilmListeners>;
template class test::PathRounds<kPlainDiffuse | test::kTwoNodeTree, Listeners<test::DensityListener>, test::DensityJob>;
template class test::PathRounds<kPlainDiffuse | test::kAbsorbing, FilmListeners>;
template class test::PathRounds<kPlainDiffuse | test::kScattering, FilmListeners>;
template class test::PathRounds<kPlainDiffuse, test::CoverageListeners<2>, test::CoverageJob<2>>;
template class test::PathRounds<kPlainDiffuse, test::CoverageListeners<6>, test::CoverageJob<6>>;
template void launch(Queue&, const char*, WorkCount, const test::AddCoverage<2>&);
template void launch(Queue&, const char*, WorkCount, const test::AddCoverage<6>&);
} // namespace pertev
