// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/ray_scene.h"
#include "viewer/gl_picture.h"
#include "viewer/gl_scene.h"
#include "viewer/photographs.h"
#include "viewer/viewer_state.h"

namespace lfm {

/// A photograph, the scene from its camera, and their difference, side by side. Needs a current
/// context, the same one for its whole life.
class PhotographView {
 public:
  /// `capture` may be empty: cameras without pictures then. Throws Error as FindPhotographs does.
  PhotographView(const std::filesystem::path& work, const std::filesystem::path& capture);

  const std::vector<PosedPhotograph>& photographs() const { return photographs_; }
  bool HasPictures() const { return !capture_.empty(); }
  /// None with that id: nullptr.
  const PosedPhotograph* Find(const std::string& id) const;

  /// The scene from the photograph's camera (where it stands in the scene) as the state shows it,
  /// without edges, compared anew where either has changed since the last time: over the silhouette
  /// of the dense surface (WORK/mesh), never of the model; without one over what the model covers
  /// wholly. Throws Error when the photograph cannot be read.
  void Compare(const PosedPhotograph& photograph, const Pose& camera_from_world,
               const GlScene& scene, const ViewerState& state);
  /// Forgets what it knows of the scene, which has changed.
  void SceneChanged() { compared_.reset(); }
  /// What Compare found.
  const PhotographDifference& difference() const { return difference_; }
  /// Draws photograph, rendering and difference, as large as they get right of column `left`, into
  /// the bound framebuffer, which has width x height pixels and is cleared first.
  void Draw(int left, int width, int height, const Eigen::Vector3f& background) const;

 private:
  struct Compared {
    std::string id;
    GlRenderOptions options;
  };
  void Read(const PosedPhotograph& photograph);

  std::filesystem::path capture_;
  std::vector<PosedPhotograph> photographs_;
  std::optional<RayScene> surface_;
  std::string read_;  ///< the id of `picture_`
  PinholePicture picture_;
  std::optional<Compared> compared_;
  PhotographDifference difference_;
  std::vector<GlPicture> shown_;
};

/// A photograph's camera without its lens's distortion, in the middle of a window of this size.
Camera CameraInWindow(const Camera& camera, int width, int height);

}  // namespace lfm
