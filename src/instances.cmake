# Each row makes a file that only instantiates templates, by the functions of cmake/instances.cmake.

# Traversals of the laboratory; tracer/kernels/lab/add_lab_kernels.cpp calls each.
pertev_lab_kernels(brute_force trace/brute_force_traversal.h
  "add_unordered_kernels<BruteForceTraversal>(TraversalKind::BruteForce, rows)")
pertev_lab_kernels(compressed trace/wide/compressed_traversal.h
  "add_other_kernels<CompressedTraversal, true>(TraversalKind::Compressed, rows)"
  "add_kernels<CompressedTraversal, TraversalOptions{.tests = TestKind::Fast, .rta_at_pops = false}, true>(TraversalKind::Compressed, rows)")
pertev_lab_kernels(if_if trace/binary/if_if_traversal.h
  "add_all_kernels<IfIfTraversal>(TraversalKind::IfIf, rows)")
pertev_lab_kernels(kd_tree trace/cells/kd_tree_traversal.h
  "add_all_kernels<KdTreeTraversal>(TraversalKind::Kd, rows)")
pertev_lab_kernels(octant trace/binary/octant_traversal.h
  "add_other_kernels<OctantTraversal>(TraversalKind::Octants, rows)")
pertev_lab_kernels(octree trace/cells/octree_traversal.h
  "add_all_kernels<OctreeTraversal>(TraversalKind::Octree, rows)")
pertev_lab_kernels(parent_links trace/binary/parent_links_traversal.h
  "add_all_kernels<ParentLinksTraversal>(TraversalKind::ParentLinks, rows)")
pertev_lab_kernels(restart_trail trace/binary/restart_trail_traversal.h
  "add_all_kernels<RestartTrailTraversal>(TraversalKind::RestartTrail, rows)")
pertev_lab_kernels(short_stack trace/binary/short_stack_traversal.h
  "add_all_kernels<ShortStackTraversal>(TraversalKind::ShortStack, rows)")
pertev_lab_kernels(skip_links trace/binary/skip_links_traversal.h
  "add_unordered_kernels<SkipLinksTraversal>(TraversalKind::SkipLinks, rows)")
pertev_lab_kernels(speculative trace/binary/speculative_traversal.h
  "add_all_kernels<SpeculativeTraversal, true>(TraversalKind::Speculative, rows)"
  "add_woop_kernels<SpeculativeTraversal>(TraversalKind::Speculative, rows)")
pertev_lab_kernels(while_while trace/binary/while_while_traversal.h
  "add_other_kernels<WhileWhileTraversal, true>(TraversalKind::WhileWhile, rows)"
  "add_woop_kernels<WhileWhileTraversal>(TraversalKind::WhileWhile, rows)")
pertev_lab_kernels(wide trace/wide/wide_traversal.h
  "add_all_kernels<Wide4Traversal>(TraversalKind::Wide4, rows)"
  "add_all_kernels<Wide8Traversal>(TraversalKind::Wide8, rows)")

# Integrators that are made of a machine of several.
pertev_integrator(bidirectional integrators/subpaths/subpath_integrator.h "SubpathIntegrator<BothDirections>")
pertev_integrator(cast integrators/ray_tree/ray_tree_integrator.h "RayTreeIntegrator<Cast>")
pertev_integrator(distributed integrators/ray_tree/ray_tree_integrator.h "RayTreeIntegrator<Distributed>")
pertev_integrator(light integrators/subpaths/subpath_integrator.h "SubpathIntegrator<ParticlesAlone>")
pertev_integrator(whitted integrators/ray_tree/ray_tree_integrator.h "RayTreeIntegrator<Whitted>")

# Shading on a CPU, a file of its own for each: it takes a minute.
pertev_host_shading(films FilmListeners FilmFeatures)
pertev_host_shading(frames ReuseListeners FrameFeatures)
pertev_host_shading(layers LayerListeners LayerFeatures)

# Stages of device_scene.
pertev_launches(device_scene/mesh_stages.cu
  device_scene/classify_opacity.h device_scene/halve_texture.h scene/deform_vertices.h
  STAGES DeformVertices
    HalveTexture
    HalveTexelBounds
    ClassifyOpacity)

# Stages of tracer.
pertev_launches(tracer/deforming_stages.cu
  tracer/refit_wide.h
  STAGES ListTriangles
    LinkWideParents
    RefitWide)

# Stages of render.
pertev_launches(render/add_frame_to_film.cu
  render/add_frame_to_film.h
  STAGES AddFrameToFilm
    InWindow<AddFrameToFilm>)
pertev_launches(render/centre_layers.cu
  render/centre_layers.h
  STAGES MakeCentreRays
    "StoreCentres<ShadingVariant::PlainDiffuse, false>"
    "StoreCentres<ShadingVariant::General, false>"
    "StoreCentres<ShadingVariant::General, true>")
pertev_launches(render/film_stages.cu
  render/film_stages.h
  STAGES AddSums
    AddIds
    AddMissing
    AddCounts
    AddFrames
    ResolveFilm
    DisplayFilm)
pertev_launches(render/sample_layers/sample_stages.cu
  render/sample_layers/first_hits.h render/sample_layers/variance_target.h
  STAGES MakeSampleRays
    AddFirstHits
    CountSamples
    AddMattes
    AddMoments
    AddSampleCounts
    AddUvSums
    TakeMoments)
pertev_launches(render/raster/tile_lists.cu
  render/raster/find_in_tile.h
  STAGES BinTriangles
    BinRows
    FinishTileLists
    FindInTiles)

# Stages of denoise.
pertev_launches(denoise/frame_stages.cu
  denoise/aim_at_moved.h denoise/compare_light.h denoise/contacts.h denoise/keep_layers.h denoise/motion_vectors.h denoise/sum_blocks.h
  denoise/upsample_picture.h render/row_band.h
  STAGES CentreRays
    MotionOfHits
    AimAtMoved
    CompareLight
    SpreadLight
    FindChangedShare
    ContactRays
    StoreContacts
    "FromPixel<UpsamplePicture>"
    SumBlockRows
    MeanOfBlockRows
    "FromPixel<KeepLayers>")
pertev_launches(denoise/oidn/oidn_stages.cu
  denoise/oidn/oidn_stages.h render/pixel_window.h
  STAGES MeanOidnGuides
    InWindow<MeanOidnGuides>
    AddOidnGuides
    InWindow<AddOidnGuides>
    FinishOidnGuides
    ReadShownFrame
    ShowColor)
pertev_launches(denoise/picture_denoiser_stages.cu
  denoise/compose_samples.h denoise/estimate_variance.h denoise/even_pass.h denoise/fade_filter.h denoise/finish_sums.h
  denoise/gather_mirrors.h denoise/mix_history.h render/pixel_window.h
  STAGES BeginSums
    FinishSums
    BeginMirrors
    GuideMirrors
    GatherMirrors
    InWindow<GatherMirrors>
    EstimateMirrorVariance
    EvenPass
    MirrorPass
    GatherFeatures
    InWindow<GatherFeatures>
    GatherLight
    InWindow<GatherLight>
    SmoothGuide
    EstimateVariance
    ReprojectHistory
    CompareHistory
    AverageDifference
    MixHistory
    GatherNoise
    GatherMirrorNoise
    FadeSignals
    ComposeSamples
    MixMean)
pertev_launches(denoise/reconstruction_stages.cu
  denoise/accumulate_signals.h denoise/anti_alias.h denoise/clamp_history.h denoise/compose_picture.h
  denoise/split_signals.h denoise/wavelet_pass.h
  STAGES "FromPixel<SplitSignals>"
    "AccumulateSignals<false>"
    "AccumulateSignals<true>"
    ClampHistory
    WaveletPass
    "FromPixel<ComposePicture>"
    AntiAlias
    ShowPicture)

# Stages of restir.
pertev_launches(restir/direct_stages.cu
  restir/add_direct_light.h restir/find_neighbours.h restir/initial_candidates.h restir/reuse_reservoirs.h render/row_band.h
  STAGES "FromPixel<SampleInitialCandidates<ShadingVariant::General>>"
    "FromPixel<SampleInitialCandidates<ShadingVariant::Unstacked>>"
    "FromPixel<SampleInitialCandidates<ShadingVariant::Diffuse>>"
    "FromPixel<FindBefore>"
    "FromPixel<FindNeighbours>"
    "FromPixel<ReuseReservoirs<LightReservoir, ShadingVariant::General>>"
    "FromPixel<ReuseReservoirs<LightReservoir, ShadingVariant::Unstacked>>"
    "FromPixel<ReuseReservoirs<LightReservoir, ShadingVariant::Diffuse>>"
    "QueueVisibilityRays<LightReservoir>"
    "CountVisible<LightReservoir>"
    "FromPixel<FinishReuse<LightReservoir>>"
    "FromPixel<AddDirectLight<ShadingVariant::General>>"
    "FromPixel<AddDirectLight<ShadingVariant::Unstacked>>"
    "FromPixel<AddDirectLight<ShadingVariant::Diffuse>>")
# For lights that are selected by a tree.
pertev_launches(restir/tree_candidates.cu
  restir/initial_candidates.h render/row_band.h
  STAGES "FromPixel<SampleInitialCandidates<ShadingVariant::General, ChosenByTree>>"
    "FromPixel<SampleInitialCandidates<ShadingVariant::Unstacked, ChosenByTree>>"
    "FromPixel<SampleInitialCandidates<ShadingVariant::Diffuse, ChosenByTree>>")
pertev_launches(restir/indirect_stages.cu
  restir/add_indirect_light.h restir/initial_gi_reservoirs.h restir/reuse_reservoirs.h render/row_band.h
  STAGES "FromPixel<MakeInitialGiReservoirs<ShadingVariant::General>>"
    "FromPixel<MakeInitialGiReservoirs<ShadingVariant::Unstacked>>"
    "FromPixel<MakeInitialGiReservoirs<ShadingVariant::Diffuse>>"
    "FromPixel<ReuseReservoirs<BounceReservoir, ShadingVariant::General>>"
    "FromPixel<ReuseReservoirs<BounceReservoir, ShadingVariant::Unstacked>>"
    "FromPixel<ReuseReservoirs<BounceReservoir, ShadingVariant::Diffuse>>"
    "QueueVisibilityRays<BounceReservoir>"
    "CountVisible<BounceReservoir>"
    "FromPixel<FinishReuse<BounceReservoir>>"
    "FromPixel<AddIndirectLight<ShadingVariant::General>>"
    "FromPixel<AddIndirectLight<ShadingVariant::Unstacked>>"
    "FromPixel<AddIndirectLight<ShadingVariant::Diffuse>>")

# Stages of integrators.
pertev_launches(integrators/bidirectional/camera_subpath_stages.cu
  integrators/bidirectional/camera_subpath_stages.h
  STAGES "ShadeCameraSubpaths<ShadingVariant::General>"
    "ShadeCameraSubpaths<ShadingVariant::Unstacked>"
    "ShadeCameraSubpaths<ShadingVariant::PlainDiffuse>"
    "ConnectSubpaths<ShadingVariant::General>"
    "ConnectSubpaths<ShadingVariant::Unstacked>"
    "ConnectSubpaths<ShadingVariant::PlainDiffuse>")
# For media.
pertev_launches(integrators/bidirectional/camera_media_stages.cu
  integrators/bidirectional/camera_subpath_stages.h
  STAGES "ShadeCameraSubpaths<ShadingVariant::General, true>"
    "ConnectSubpaths<ShadingVariant::General, true>")
# For lights that are selected by a tree.
pertev_launches(integrators/bidirectional/camera_tree_stages.cu
  integrators/bidirectional/camera_subpath_stages.h
  STAGES "ShadeCameraSubpaths<ShadingVariant::General, false, ChosenByTree>"
    "ShadeCameraSubpaths<ShadingVariant::Unstacked, false, ChosenByTree>"
    "ShadeCameraSubpaths<ShadingVariant::General, true, ChosenByTree>")
pertev_launches(integrators/cast/shade_cast.cu
  integrators/cast/cast.h integrators/ray_tree/tree_stages.h
  STAGES "ShadeTrees<Cast, ShadingVariant::General>"
    "ShadeTrees<Cast, ShadingVariant::Unstacked>")
# For lights that are selected by a tree.
pertev_launches(integrators/distributed/shade_distributed_by_tree.cu
  integrators/distributed/distributed.h integrators/ray_tree/tree_stages.h
  STAGES "ShadeTrees<Distributed, ShadingVariant::General, ChosenByTree>")
pertev_launches(integrators/distributed/shade_distributed.cu
  integrators/distributed/distributed.h integrators/ray_tree/tree_stages.h
  STAGES "ShadeTrees<Distributed, ShadingVariant::General>"
    "ShadeTrees<Distributed, ShadingVariant::Unstacked>")
pertev_launches(integrators/irradiance_cache/cache_stages.cu
  integrators/irradiance_cache/cache_stages.h integrators/irradiance_cache/hemisphere_stages.h
  integrators/irradiance_cache/lookup_stages.h integrators/irradiance_cache/overture_grid.h
  STAGES BeginCacheSubpaths
    CountMirroredEmitters
    BeginSeekers
    StoreDistances
    ReadCells
    "ShadeCacheSubpaths<ShadingVariant::General>"
    "ShadeCacheSubpaths<ShadingVariant::Unstacked>"
    "ShadeCacheSubpaths<ShadingVariant::PlainDiffuse>"
    "BeginHemispheres<ShadingVariant::General>"
    "BeginHemispheres<ShadingVariant::Unstacked>"
    "BeginHemispheres<ShadingVariant::PlainDiffuse>"
    "FinishRecords<ShadingVariant::General>"
    "FinishRecords<ShadingVariant::Unstacked>"
    "FinishRecords<ShadingVariant::PlainDiffuse>"
    "LookUpRadiance<ShadingVariant::General>"
    "LookUpRadiance<ShadingVariant::Unstacked>"
    "LookUpRadiance<ShadingVariant::PlainDiffuse>"
    "FindRecordSites<ShadingVariant::General>"
    "FindRecordSites<ShadingVariant::Unstacked>"
    "FindRecordSites<ShadingVariant::PlainDiffuse>"
    "DrawRecords<ShadingVariant::General>"
    "DrawRecords<ShadingVariant::Unstacked>"
    "DrawRecords<ShadingVariant::PlainDiffuse>")
# For lights that are selected by a tree.
pertev_launches(integrators/irradiance_cache/cache_tree_stages.cu
  integrators/irradiance_cache/cache_stages.h
  STAGES "ShadeCacheSubpaths<ShadingVariant::General, ChosenByTree>")
pertev_launches(integrators/light/shade_seen.cu
  integrators/light/shade_seen.h
  STAGES "ShadeSeen<ShadingVariant::General>"
    "ShadeSeen<ShadingVariant::Unstacked>")
pertev_launches(integrators/path/meter_light.cu
  integrators/path/meter_light.h
  STAGES DrawMeterLights
    AddMeterLights)
# Stages that compile quickly; shading has files of its own.
pertev_launches(integrators/path/path_stages.cu
  integrators/path/path_stages.h
  STAGES PlanRound
    CountGroups
    OrderHits
    "GeneratePaths<false>"
    "GeneratePaths<true>"
    "AddLight<FilmListeners>"
    "AddLight<PlainFrameListeners>"
    "AddLight<FrameListeners>"
    "AddLight<PlainReuseListeners>"
    "AddLight<ReuseListeners>"
    "AddLight<LayerListeners>")
# Shading by masks of features: the file and the mask, from the least code on.
pertev_shading_kernels(FilmFeatures FilmListeners FilmListeners
  "films: kPlainDiffuse"
  "films: kDiffuse"
  "films: kUnstacked"
  "stacks: kAllMaterials"
  "moving_films: kPlainDiffuse | kMoving"
  "moving_films: kDiffuse | kMoving"
  "moving_films: kUnstacked | kMoving"
  "batches: kPlainDiffuse | kBatched"
  "batches: kDiffuse | kBatched"
  "batches: kUnstacked | kBatched"
  "batches: kUnstacked | kMoving | kBatched"
  "stacks: kAnyFilm"
  "light_tree_films: kUnstacked | kLightTree"
  "light_tree_films: kAnyFilm | kLightTree"
  "media: kAnyFilm | kMedia"
  "media: kAnyFilm | kMedia | kLightTree")
pertev_shading_kernels(FrameFeatures PlainFrameListeners FrameListeners
  "frames: kPlainDiffuse"
  "frames: kDiffuse | kMipMapped"
  "frames: kUnstacked | kMipMapped"
  "stacks_of_frames: kAllMaterials | kMipMapped | kNested"
  "light_tree_parts: kAllMaterials | kMipMapped | kNested | kLightTree"
  "media_parts: kAllMaterials | kMipMapped | kNested | kMedia")
pertev_shading_kernels(ReuseFeatures PlainReuseListeners ReuseListeners # frames that leave light to ReSTIR
  "reused_frames: kPlainDiffuse"
  "reused_frames: kDiffuse | kMipMapped"
  "reused_frames: kUnstacked | kMipMapped"
  "stacks_of_frames: kAllMaterials | kMipMapped | kNested"
  "light_tree_parts: kAllMaterials | kMipMapped | kNested | kLightTree")
pertev_shading_kernels(LayerFeatures LayerListeners LayerListeners
  "layers: kUnstacked"
  "layers: kUnstacked | kMoving"
  "stacks_of_frames: kAllMaterials | kMoving | kMipMapped | kNested"
  "light_tree_parts: kAllMaterials | kMoving | kMipMapped | kNested | kLightTree"
  "media_parts: kAllMaterials | kMoving | kMipMapped | kNested | kMedia")
pertev_write_shading_kernels()
pertev_launches(integrators/photon_map/photon_stages.cu
  integrators/photon_map/gather_stages.h integrators/photon_map/order_photons.h integrators/photon_map/photon_stages.h
  integrators/photon_map/photon_targets.h
  STAGES FindSpecular
    BeginPhotons
    NumberPhotons
    OrderPhotons
    MakeBuckets
    FindBuckets
    KeepPhotons
    BeginGather
    "ShadePhotons<ShadingVariant::General>"
    "ShadePhotons<ShadingVariant::Unstacked>"
    "ShadePhotons<ShadingVariant::PlainDiffuse>"
    "ShadeGather<ShadingVariant::General>"
    "ShadeGather<ShadingVariant::Unstacked>"
    "ShadeGather<ShadingVariant::PlainDiffuse>")
# For media.
pertev_launches(integrators/photon_map/photon_media_stages.cu
  integrators/photon_map/gather_stages.h integrators/photon_map/photon_stages.h
  STAGES "ShadePhotons<ShadingVariant::General, true>"
    "ShadeGather<ShadingVariant::General, true>")
# For lights that are selected by a tree.
pertev_launches(integrators/photon_map/photon_tree_stages.cu
  integrators/photon_map/gather_stages.h
  STAGES "ShadeGather<ShadingVariant::General, false, ChosenByTree>"
    "ShadeGather<ShadingVariant::General, true, ChosenByTree>")
pertev_launches(integrators/radiosity/shade_radiosity.cu
  integrators/radiosity/radiosity.h integrators/ray_tree/tree_stages.h
  STAGES "ShadeTrees<Radiosity, ShadingVariant::General>"
    "ShadeTrees<Radiosity, ShadingVariant::Unstacked>")
pertev_launches(integrators/raster/scan_triangles.cu
  integrators/raster/scan_triangles.h integrators/raster/shade_pixels.h
  STAGES ScanTriangles
    ScanRows
    DrawEdges
    "InWindow<ShadePixels<ShadingVariant::General>>"
    "InWindow<ShadePixels<ShadingVariant::Unstacked>>")
pertev_launches(integrators/ray_tree/tree_stages.cu
  integrators/ray_tree/tree_stages.h
  STAGES BeginTrees
    BeginRounds
    AddTreeLight
    TakeNextRays
    CountTrees)
pertev_launches(integrators/reyes/split_stages.cu
  integrators/reyes/shade_samples.h integrators/reyes/split_stages.h
  STAGES PositionSamples
    FindFar
    TakePieces
    "SplitPieces<HidingPass::FindNearest>"
    "SplitPieces<HidingPass::FindMicropolygon>"
    "InWindow<ShadeSamples>")
pertev_launches(integrators/subpaths/particle_stages.cu
  integrators/subpaths/particle_stages.h
  STAGES BeginParticles
    BeginCameraSubpaths
    AddSplats
    AddConnections
    CountSubpaths
    BeginSubpaths
    "ShadeParticles<ShadingVariant::General>"
    "ShadeParticles<ShadingVariant::Unstacked>"
    "ShadeParticles<ShadingVariant::PlainDiffuse>")
# For media.
pertev_launches(integrators/subpaths/particle_media_stages.cu
  integrators/light/shade_seen.h
  STAGES "ShadeParticles<ShadingVariant::General, true>"
    "ShadeSeen<ShadingVariant::General, true>")
# For bidirectional's lights that are selected by a tree.
pertev_launches(integrators/subpaths/particle_tree_stages.cu
  integrators/subpaths/particle_stages.h
  STAGES "ShadeParticles<ShadingVariant::General, false, ChosenByTree>"
    "ShadeParticles<ShadingVariant::Unstacked, false, ChosenByTree>"
    "ShadeParticles<ShadingVariant::General, true, ChosenByTree>")
pertev_launches(integrators/whitted/shade_whitted.cu
  integrators/ray_tree/tree_stages.h integrators/whitted/whitted.h
  STAGES "ShadeTrees<Whitted, ShadingVariant::General>"
    "ShadeTrees<Whitted, ShadingVariant::Unstacked>")

# Stages of lab.
pertev_launches(lab/brute_force_rays.cu
  lab/brute_force_rays.h
  STAGES BruteForceRays)
