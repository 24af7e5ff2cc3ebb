#pragma once

// Nodes between which links transport light: clusters of triangles at the top, triangles, their patches and the
// patches into which these were divided below. Light that a cluster receives is stored by direction, in the same
// three sums as its sent light, so that each triangle below takes the part that its normal determines.
//
// Sources: clusters that send and receive: Sillion, "A Unified Hierarchical Algorithm for Global Illumination with
// Scattering Volumes and Object Clusters", IEEE TVCG 1(3), 1995; their light by direction: Christensen, Lischinski,
// Stollnitz, Salesin, "Clustering for Glossy Global Illumination", ACM TOG 16(1), 1997.

#include <span>
#include <vector>

#include "radiosity/cluster_tree.h"
#include "radiosity/form_factor_row.h"
#include "radiosity/link_oracle.h"
#include "radiosity/links.h"
#include "radiosity/radiosity_settings.h"
#include "radiosity/solved_scene.h"
#include "radiosity/work_watch.h"

namespace pertev {

class RowMaker;

class LinkNodes {
public:
    /// Makes the nodes. `coarse` has whole triangles. Patches with edges shorter than `patch_size` (metres) are not
    /// divided. `scene` and `watch` outlive it.
    LinkNodes(const SolvedScene& scene, PatchTree coarse, float patch_size, const RadiositySettings& settings,
              WorkWatch& watch);

    /// Code of the whole scene; for a single triangle side, of its patch.
    NodeCode root() const { return code_of_cluster(0); }
    /// Code of a cluster, or of its triangle if it has only one.
    NodeCode code_of_cluster(uint32_t cluster) const;
    const Cluster& cluster(NodeCode code) const { return clusters_.clusters[cluster_of(code)]; }
    const Ball& ball(NodeCode code) const { return is_cluster(code) ? cluster(code).ball : shape(code).ball; }
    const LinkedPatch& shape(PatchCode code) const {
        return is_patch(code) ? patch_shapes_[number_of(code)] : quad_shapes_[code];
    }
    const Patch& patch(PatchCode code) const {
        return is_patch(code) ? tree_.patches[number_of(code)] : quad_patches_[code];
    }
    const PatchQuad& quad(PatchCode code) const { return tree_.quads[code]; }
    const PatchTree& tree() const { return tree_; }
    /// The triangle of a cluster at the fraction `u`, in [0, 1), of its area.
    PatchCode triangle_at(const Cluster& cluster, double u) const;
    /// Area of a node, m2; half of a cluster's belongs to backs.
    float area(NodeCode code) const;

    /// Reflected light that leaves a node, W/m2; for a cluster the maximum of its triangles.
    Rgb sent(PatchCode code) const { return is_patch(code) ? patch_sent_[number_of(code)] : quad_sent_[code]; }
    float max_sent(NodeCode code) const {
        return is_cluster(code) ? max_sent_[cluster_of(code)] : luminance(sent(code));
    }
    /// Sum of A B max(cosine, 0) towards `direction` (unit), W.
    Rgb power_towards(NodeCode code, Vec3 direction) const;
    Rgb power(NodeCode code) const;

    /// Mean direct light of patches that have any: luminance, W/m2.
    float mean_direct() const { return static_cast<float>(mean_of_lit(direct_)); }
    bool can_divide(NodeCode code) const {
        return is_cluster(code) || !is_patch(code) || shape(code).longest > patch_size_;
    }
    /// Returns whether direct light varies over the patch by more than `limit`, W/m2.
    bool direct_changes(uint32_t patch, float limit) const { return direct_spread_[patch] > limit; }

    /// Gathers over all links, which are sorted by receiver, and passes light down and up. Returns the share of the
    /// light that has changed.
    double sweep(std::span<const Link> links);

    /// Share of the patches that are black because the watch was over before their direct light was found.
    double without_direct() const { return without_direct_; }

    /// Sorts links by receiver; the order of those of one receiver is stable.
    void sort(std::vector<Link>& links) const;

    /// Divides the patches that are marked, [patches].
    void divide(std::span<const uint8_t> requested);
    /// Updates a link from before the last divide().
    Link after_division(Link link) const {
        link.receiver = now(link.receiver);
        link.source = now(link.source);
        return link;
    }

    const std::vector<Rgb>& irradiance() const { return irradiance_; } // [patches] W/m2
    const std::vector<Rgb>& direct() const { return direct_; }         // part of it that is direct light
    PatchTree take_tree() { return std::move(tree_); }
    std::size_t bytes() const;
    /// Maximum bytes for these numbers of patches and triangle sides.
    static std::size_t max_bytes(uint64_t patches, uint64_t faces);
    /// Additional maximum bytes during construction, before there are links.
    static std::size_t max_first_bytes(uint64_t faces);

private:
    NodeCode now(NodeCode code) const {
        if (!is_patch(code) || number_of(code) >= became_.size()) return code;
        const PatchCode quad = became_[number_of(code)];
        return quad == kNoPatch ? code : quad;
    }
    std::size_t index_of(NodeCode code) const;
    std::size_t index_count() const { return clusters_.clusters.size() + tree_.quads.size() + tree_.patches.size(); }
    void add_patches();
    /// Estimates indirect light before there are links, from the rays that found the direct light. It is approximate,
    /// but distinguishes lit patches from those inside walls and pillars; links are then refined according to it.
    void spread_first_light();
    double mean_of_lit(std::span<const Rgb> light) const; // [patches]; 0 if all is black
    bool find_direct(uint32_t patch, RowMaker& of_whole, RowMaker& of_quarter);
    void gather(std::span<const Link> links);
    double pass_on();
    void receive(NodeCode receiver, std::span<const Link> links);
    /// Radiosity of a patch or its tree of parts, W/m2, and the leaving light and its change, W.
    struct Pushed {
        Rgb sent;
        double changed = 0, all = 0;
    };
    friend Pushed operator+(const Pushed& a, const Pushed& b) {
        return {a.sent + b.sent, a.changed + b.changed, a.all + b.all};
    }
    Pushed push(PatchCode code, Rgb above);
    void send();

    const SolvedScene& scene_;
    const SceneView& view_;
    uint32_t seed_;
    float patch_size_;
    WorkWatch& watch_;
    PatchTree tree_;
    ClusterTree clusters_;
    std::vector<double> area_before_; // [triangles of clusters_ + 1] m2
    std::vector<LinkedPatch> patch_shapes_, quad_shapes_;
    std::vector<Patch> quad_patches_; // the patches that quads replaced
    std::vector<Rgb> direct_, gathered_, irradiance_, patch_sent_, quad_gathered_, quad_sent_; // W/m2
    std::vector<float> direct_spread_;                                                         // luminance, W/m2
    std::vector<SentLight> cluster_sent_, cluster_received_; // the latter W/m2, by direction of arrival
    std::vector<Rgb> cluster_gathered_;                      // independent of direction, W/m2
    std::vector<float> max_sent_;
    std::vector<PatchCode> became_;                   // [patches] quads that replaced them
    std::vector<uint32_t> stale_;                     // patches whose direct light must be found
    std::vector<std::vector<FormFactor>> first_rows_; // [patches] until there are links
    double without_direct_ = 0;
};

} // namespace pertev
