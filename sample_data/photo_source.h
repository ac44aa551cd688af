// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <string>

#include "core/progress.h"
#include "sample_data/light_baking.h"
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
  /// The lamps and the room, for what stands in the way.
  virtual const Lighting& lighting() const = 0;
  /// Radiance of the best lit white paper of the plate; positive.
  virtual double BrightestPaper() const = 0;
  /// What all pictures so far have cost, in a sentence; empty when it was not counted.
  virtual std::string Costs() const = 0;
};

/// The painted subject with light baked at its vertices: fast, for paint alone. Arguments must
/// outlive the source.
std::unique_ptr<PhotoSource> MakeBakedSource(const StudioScene& scene, const Subject& subject,
                                             const SetReflectance& reflectance,
                                             const BakeOptions& options, Progress& progress);

/// Any light field scene on the plate, by path tracing with `samples` a pixel. Throws Error when
/// the scene cannot be traced (traced_scene.h, path_tracer.h) or the plate is dark.
std::unique_ptr<PhotoSource> MakeTracedSource(const SceneDescription& scene,
                                              std::vector<Patch> patches,
                                              const SetReflectance& reflectance, int samples,
                                              uint64_t seed);

}  // namespace lfm
