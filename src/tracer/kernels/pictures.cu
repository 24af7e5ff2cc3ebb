// The traversals that pictures take by default (tracer/tracer_choice.h), and the one of single rays that are measured.

#include "trace/binary/octant_traversal.h"
#include "trace/binary/while_while_traversal.h"
#include "trace/wide/compressed_traversal.h"
#include "tracer/kernels/traversal_kernels_body.h"

namespace pertev {

/// The traversal of camera rays in pictures.
template <>
inline constexpr bool kOfPictures<OctantTraversal<TraversalOptions{}>> = true;
/// The traversal of bounce and shadow rays in pictures.
template <>
inline constexpr bool kOfPictures<CompressedTraversal<TraversalOptions{.rta_at_pops = false}>> = true;
template <>
inline constexpr bool kOfPictures<CompressedTraversal<for_any_hit(TraversalOptions{})>> = true;

void add_picture_kernels(std::vector<TraversalKernel>& rows) {
    add_kernels<OctantTraversal, TraversalOptions{}, false>(TraversalKind::Octants, rows);
    add_kernels<CompressedTraversal, TraversalOptions{}, true>(TraversalKind::Compressed, rows);
    add_kernels<CompressedTraversal, TraversalOptions{.rta_at_pops = false}, true>(TraversalKind::Compressed, rows);
    add_kernels<WhileWhileTraversal, TraversalOptions{}, true>(TraversalKind::WhileWhile, rows);
}

} // namespace pertev
