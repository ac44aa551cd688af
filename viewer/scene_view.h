// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <deque>
#include <filesystem>
#include <memory>
#include <optional>
#include <vector>

#include "core/ray_scene.h"
#include "viewer/gl_marks.h"
#include "viewer/gl_scene.h"
#include "viewer/model_loader.h"
#include "viewer/photograph_view.h"
#include "viewer/scene_overlay.h"
#include "viewer/viewer_state.h"
#include "viewer/viewer_status.h"

namespace lfm {

/// What dropped files do to what is shown.
enum class Dropped { kReplaces, kJoins };

/// The scene of the interactive viewer: its models as they arrive, what is drawn over them, and
/// what lies under the pointer. Needs a current context, the same one for its whole life.
class SceneView {
 public:
  SceneView(const ViewOptions& options, BlockUse block_use);

  /// Begins to read these models, in place of what is shown.
  void Load(std::vector<SceneEntry> entries);
  /// The same of files as a user drops them: models stand beside one another, scenes as they say.
  /// Those that join wait until what is being read is there. Throws Error when a scene file is
  /// wrong.
  void LoadFiles(const std::vector<std::filesystem::path>& files, Dropped dropped);
  bool IsReading() const;
  /// Shows models that have been read already, in place of what is shown.
  ViewerState Show(ViewerState state, const Scene& scene);
  /// Photographs of the first model's object. Throws Error as PhotographView does.
  void ShowPhotographsOf(const std::filesystem::path& work, const std::filesystem::path& capture);

  /// Shows what has been read since the last time.
  ViewerState TakeArrivals(ViewerState state);
  /// Moves models to where the state has them.
  ViewerState PlaceModels(ViewerState state);
  /// What a click means.
  ViewerState ApplyClick(ViewerState state, PictureSize size);
  /// What has to be known before a draw; draws elsewhere meanwhile.
  ViewerState Prepare(ViewerState state);
  /// Draws into the bound framebuffer of that size. What is side by side lies right of column
  /// `left`, where there is room.
  void Draw(const ViewerState& state, PictureSize size, int left = 0);
  /// What it knows, into its part of `status`.
  ViewerStatus Report(const ViewerState& state, ViewerStatus status) const;

  /// The camera that the state shows the scene with.
  PosedCamera CameraOf(const ViewerState& state, PictureSize size) const;
  /// Where the ray through that pixel meets the scene first.
  std::optional<Eigen::Vector3d> PointUnder(const PosedCamera& camera,
                                            const Eigen::Vector2d& pixel);

 private:
  ViewerState Rebuilt(ViewerState state);
  ViewerState Put(ViewerState state, const ModelLoader::Arrival& arrival);
  std::vector<int> CountUsedPhotographs() const;
  void DrawLines(const ViewerState& state, const GlView& view) const;
  const PosedPhotograph* PhotographOf(const ViewerState& state) const;
  /// The photographs' cameras move with the first model, whose object they show.
  std::vector<PosedPhotograph> PhotographsInScene() const;
  PosedCamera InScene(PosedCamera camera) const;
  bool SeesCameras(const ViewerState& state) const;
  /// Models to be read.
  struct Loading {
    std::vector<SceneEntry> entries;
    Dropped dropped;
    bool beside;  ///< placed beside what is there
  };
  void Begin(Loading load);
  void SayFault(const std::string& fault);
  bool Compares(const ViewerState& state) const;
  double FrustumDepth() const;

  ViewOptions options_;
  BlockUse block_use_;
  std::unique_ptr<ModelLoader> loader_;
  std::vector<SceneEntry> entries_;  ///< of the loader
  std::vector<size_t> places_;       ///< of the entries, in scene_; kNotShown before they arrive
  bool beside_ = false;              ///< the loader's models are placed beside what is there
  bool replace_ = false;             ///< what is shown goes when the first model arrives
  Scene scene_;
  std::vector<std::filesystem::path> files_;  ///< of its models
  GlScene drawn_;
  std::optional<RayScene> rays_;  ///< of mesh_, once they are needed
  TriangleMesh mesh_;             ///< of the scene, in the world
  std::unique_ptr<PhotographView> photographs_;
  SceneOverlay overlay_;
  GlLines lines_;
  bool cameras_shown_ = false;  ///< in the last frame
  std::string standing_at_;     ///< the photograph that state.camera follows
  std::string error_;
  size_t more_errors_ = 0;       ///< beside error_
  std::deque<Loading> waiting_;  ///< joining models
  std::vector<bool> whole_;      ///< of the scene's models: not only the mean view
  bool others_ = false;          ///< what is shown is not what the photographs were given for
};

}  // namespace lfm
