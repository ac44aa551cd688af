// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "core/progress.h"
#include "sample_data/light_baking.h"
#include "sample_data/occluder.h"
#include "sample_data/photo_renderer.h"
#include "sample_data/scene_description.h"
#include "sample_data/studio_scene.h"
#include "sample_data/subject.h"

namespace lfm {

/// A lit scene, ready to be photographed. Usable from many threads.
class PhotoSource {
 public:
  virtual ~PhotoSource() = default;
  virtual RenderedPhoto Render(const PixelRays& rays, const Pose& camera_from_world) const = 0;
  /// Renders the scene with something in the way that hides it, casts its shadow on it and is no
  /// object of the mask. The source must outlive the renderer.
  virtual PhotoRenderer WithOccluder(const Occluder& occluder) const = 0;
  /// The same picture as Render's, with independent random numbers; no answer from a source whose
  /// pictures know their standard error.
  virtual std::optional<RenderedPhoto> RenderAgain(const PixelRays& rays,
                                                   const Pose& camera_from_world) const = 0;
  /// Radiance of the best lit white paper of the plate; positive.
  virtual double BrightestPaper() const = 0;
  /// What it took to light the scene, before any picture.
  virtual RayCounts LightingRays() const = 0;
};

/// The painted subject with light baked at its vertices: fast, for paint alone. It is baked twice,
/// with two seeds: the second tells how far the first can be trusted (RenderAgain). An occluder's
/// shadow is that of the lamps (occluder_shadow.h). Arguments must outlive the source.
std::unique_ptr<PhotoSource> MakeBakedSource(const StudioScene& scene, const Subject& subject,
                                             const SetReflectance& reflectance,
                                             const BakeOptions& options, Progress& progress);

/// Any light field scene on the plate, by path tracing with `samples` a pixel. An occluder is an
/// object of its own. `indirect_limit` is PathTracer's, in units of the best lit paper's radiance.
/// Throws Error when the scene cannot be traced (traced_scene.h, path_tracer.h) or the plate is
/// dark.
std::unique_ptr<PhotoSource> MakeTracedSource(const SceneDescription& scene,
                                              std::vector<Patch> patches,
                                              const SetReflectance& reflectance, int samples,
                                              double indirect_limit, uint64_t seed);

}  // namespace lfm
