// SPDX-License-Identifier: BSD-3-Clause
#include "viewer/scene_view.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/error.h"
#include "core/progress.h"
#include "viewer/photograph_frusta.h"
#include "viewer/vertex_coverage.h"

namespace lfm {
namespace {

constexpr double kFrustumShare = 0.2;  // of the scene's radius
constexpr double kClickReach = 8;      // pixels
constexpr size_t kNotShown = static_cast<size_t>(-1);
const Eigen::Vector3f kCameraColor = {0.95f, 0.75f, 0.25f}, kHeldOutColor = {0.35f, 0.8f, 0.95f},
                      kChosenColor = {1, 1, 1}, kTapeColor = {1, 0.35f, 0.3f};

// Angles give a rotation back but for rounding.
bool StandsThere(const Placement& a, const Placement& b) {
  return (a.world_from_model.rotation - b.world_from_model.rotation).norm() < 1e-9 &&
         a.world_from_model.translation == b.world_from_model.translation && a.scale == b.scale;
}

}  // namespace

/// What is drawn over the scene's models or in their place.
struct SceneView::Marks {
  struct ModelColors {
    GlCornerColors drawn;
    std::vector<int> photographs;  ///< CountPhotographs, once it was asked for
  };
  GlLines lines;
  std::vector<ModelColors> models;
  Overlay overlay = Overlay::kNone;  ///< what `models` show
  Eigen::Vector3d eye = Eigen::Vector3d::Zero();
  std::vector<LegendEntry> legend;
};

SceneView::SceneView(const ViewOptions& options, BlockUse block_use)
    : options_(options), block_use_(block_use), marks_(std::make_unique<Marks>()) {}
SceneView::~SceneView() = default;

void SceneView::Load(std::vector<SceneEntry> entries, bool keep) {
  loader_.reset();  // waits for what it is reading
  error_.clear();
  entries_ = std::move(entries);
  places_.assign(entries_.size(), kNotShown);
  replace_ = !keep;
  beside_ = false;
  loader_ = std::make_unique<ModelLoader>(entries_);
}

void SceneView::LoadFiles(const std::vector<std::filesystem::path>& files, bool keep) {
  std::vector<SceneEntry> entries;
  bool scenes = false;
  for (const std::filesystem::path& file : files) {
    scenes = scenes || IsSceneFile(file);
    const std::vector<SceneEntry> more = SceneEntriesOf(file);
    entries.insert(entries.end(), more.begin(), more.end());
  }
  Load(std::move(entries), keep);
  beside_ = !scenes && (keep || files.size() > 1);
}

bool SceneView::Loading() const { return loader_ != nullptr; }

void SceneView::ShowPhotographsOf(const std::filesystem::path& work,
                                  const std::filesystem::path& capture) {
  photographs_ = std::make_unique<PhotographView>(work, capture);
}

ViewerState SceneView::TakeArrivals(ViewerState state) {
  if (!loader_) return state;
  bool changed = false;
  while (auto arrival = loader_->Next()) {
    if (!arrival->note.empty()) {
      (arrival->model.model ? state.message : error_) = arrival->note;
    }
    if (!arrival->model.model) continue;
    if (std::exchange(replace_, false)) {
      scene_.clear();
      files_.clear();
      drawn_ = {};
      state.tape.clear();
      state.touched = false;
    }
    size_t& place = places_[arrival->entry];
    if (place == kNotShown) {
      place = scene_.size();
      if (beside_) {
        arrival->model.placement = PlaceBeside(scene_, arrival->model.model->mesh);
      }
      scene_.emplace_back();
      files_.push_back(entries_[arrival->entry].file);
    } else {
      arrival->model.placement = scene_[place].placement;
    }
    try {
      drawn_.Put(place, arrival->model, block_use_);
    } catch (const Error& error) {  // too large for this graphics card
      error_ = arrival->model.name + ": " + error.what();
      if (place == drawn_.size()) {
        scene_.pop_back();
        files_.pop_back();
        place = kNotShown;
      }
      continue;
    }
    scene_[place] = std::move(arrival->model);
    changed = true;
  }
  if (loader_->Done()) loader_.reset();
  return changed ? Rebuilt(std::move(state)) : state;
}

ViewerState SceneView::Show(ViewerState state, const Scene& scene) {
  files_.resize(scene.size());
  loader_.reset();
  error_.clear();
  scene_ = scene;
  drawn_ = GlScene(scene, block_use_);
  return Rebuilt(std::move(state));
}

ViewerState SceneView::Rebuilt(ViewerState state) {
  mesh_ = SceneMesh(scene_);
  rays_.reset();
  marks_->models.clear();
  marks_->overlay = Overlay::kNone;
  marks_->legend.clear();
  if (photographs_) photographs_->SceneChanged();
  int terms = 0;
  state.models.clear();
  for (size_t i = 0; i < scene_.size(); ++i) {
    terms = std::max(terms, scene_[i].model->terms);
    state.models.push_back(ShownAt(scene_[i].name, files_[i], scene_[i].placement));
  }
  return WithScene(std::move(state), mesh_, terms, options_);
}

ViewerState SceneView::PlaceModels(ViewerState state) {
  bool moved = false;
  for (size_t i = 0; i < std::min(scene_.size(), state.models.size()); ++i) {
    const Placement placement = PlacementOf(state.models[i]);
    if (StandsThere(placement, scene_[i].placement)) continue;
    scene_[i].placement = placement;
    drawn_.Place(i, placement);
    moved = true;
  }
  if (!moved) return state;
  mesh_ = SceneMesh(scene_);
  rays_.reset();
  state.tape.clear();
  if (photographs_) photographs_->SceneChanged();
  state.touched = true;  // nothing jumps while something is moved
  return WithScene(std::move(state), mesh_, state.model_terms, options_);
}

const PosedPhotograph* SceneView::PhotographOf(const ViewerState& state) const {
  return photographs_ ? photographs_->Find(state.photograph) : nullptr;
}

double SceneView::FrustumDepth() const { return kFrustumShare * drawn_.bounds().radius; }

PosedCamera SceneView::CameraOf(const ViewerState& state, PictureSize size) const {
  if (const PosedPhotograph* photograph = PhotographOf(state)) {
    return {CameraInWindow(photograph->camera.camera, size.width, size.height),
            photograph->camera.camera_from_world};
  }
  return {PinholeCamera(state.camera, size.width, size.height), CameraFromWorld(state.camera)};
}

std::optional<Eigen::Vector3d> SceneView::PointUnder(const PosedCamera& posed,
                                                     const Eigen::Vector2d& pixel) {
  if (mesh_.triangles.empty()) return std::nullopt;
  if (!rays_) rays_.emplace(mesh_);
  const auto in_camera = TryUnproject(posed.camera, pixel);
  if (!in_camera) return std::nullopt;
  const Eigen::Vector3d eye = posed.camera_from_world.Center();
  const Eigen::Vector3d direction = posed.camera_from_world.rotation.transpose() * *in_camera;
  const auto hit = rays_->Intersect(eye, direction);
  if (!hit) return std::nullopt;
  return eye + hit->distance * direction;
}

ViewerState SceneView::ApplyClick(ViewerState state, PictureSize size) {
  const PictureClick click = *std::exchange(state.click, std::nullopt);
  if (Compares(state)) return state;
  const PosedCamera camera = CameraOf(state, size);
  const Eigen::Vector2d pixel(click.at.x() * size.width - 0.5, click.at.y() * size.height - 0.5);
  const auto point = PointUnder(camera, pixel);
  if (click.twice) {
    if (!point) return state;
    if (PhotographOf(state) != nullptr) {
      state.camera = OrbitLike(camera.camera, camera.camera_from_world, state.home);
    }
    return FocusOn(std::move(state), *point);
  }
  if (state.tool == Tool::kMeasure) {
    if (point) return AddTapeEnd(std::move(state), *point);
    state.message = "the tape holds to the surface alone; click on the object";
    return state;
  }
  if (state.show_cameras && photographs_) {
    const int picked = PickFrustum(photographs_->photographs(), FrustumDepth(), camera.camera,
                                   camera.camera_from_world, pixel, kClickReach);
    if (picked >= 0) state.photograph = photographs_->photographs()[picked].id;
  }
  return state;
}

void SceneView::DrawOverlay(const ViewerState& state, const GlView& view) {
  Marks& marks = *marks_;
  if (marks.models.size() != scene_.size()) {
    marks.models.clear();
    for (const PlacedModel& placed : scene_) {
      marks.models.push_back({GlCornerColors(placed.model->mesh), {}});
    }
  }
  const Eigen::Vector3d eye = view.camera_from_world.Center();
  const bool stale =
      marks.overlay != state.overlay || (DependsOnEye(state.overlay) && marks.eye != eye);
  for (size_t i = 0; i < scene_.size(); ++i) {
    const PlacedModel& placed = scene_[i];
    if (stale) {
      if (state.overlay == Overlay::kPhotographs && photographs_ && i == 0 &&
          marks.models[i].photographs.empty()) {
        std::vector<PosedCamera> cameras;
        for (const PosedPhotograph& one : photographs_->photographs()) {
          cameras.push_back(one.camera);
        }
        marks.models[i].photographs =
            CountPhotographs(placed.model->mesh, cameras, SilentProgress());
      }
      OverlayData data;
      data.photographs = marks.models[i].photographs;
      data.eye = placed.placement.world_from_model.Inverse() * eye / placed.placement.scale;
      const OverlayColors colors = ColorsOf(state.overlay, *placed.model, data);
      marks.models[i].drawn.SetColors(colors.corners);
      if (i == 0) marks.legend = colors.legend;
    }
    marks.models[i].drawn.DrawInto(view, placed.placement, state.edges == EdgeOverlay::kWireframe);
  }
  marks.overlay = state.overlay;
  marks.eye = eye;
}

void SceneView::DrawLines(const ViewerState& state, const GlView& view) const {
  if (photographs_ && state.show_cameras) {
    std::vector<Eigen::Vector3d> used, held_out;
    for (const PosedPhotograph& photograph : photographs_->photographs()) {
      if (photograph.id == state.photograph) continue;  // one does not see one's own
      const auto lines = FrustumLines(photograph.camera, FrustumDepth());
      std::vector<Eigen::Vector3d>& list = photograph.held_out ? held_out : used;
      list.insert(list.end(), lines.begin(), lines.end());
    }
    marks_->lines.DrawInto(view, used, kCameraColor, LineDepth::kFaintBehind);
    marks_->lines.DrawInto(view, held_out, kHeldOutColor, LineDepth::kFaintBehind);
  }
  if (state.tape.size() == 2) {
    marks_->lines.DrawInto(view, state.tape, kTapeColor, LineDepth::kFaintBehind);
  }
  // A cross at each end, as large everywhere in the picture.
  for (const Eigen::Vector3d& end : state.tape) {
    const double arm = 8 * (view.camera_from_world * end).z() / view.camera.fx;
    std::vector<Eigen::Vector3d> cross;
    for (int axis = 0; axis < 3; ++axis) {
      cross.push_back(end - arm * Eigen::Vector3d::Unit(axis));
      cross.push_back(end + arm * Eigen::Vector3d::Unit(axis));
    }
    marks_->lines.DrawInto(view, cross, kTapeColor, LineDepth::kFaintBehind);
  }
}

bool SceneView::Compares(const ViewerState& state) const {
  return state.show_photograph && PhotographOf(state) != nullptr && photographs_->HasPictures() &&
         drawn_.size() > 0;
}

ViewerState SceneView::Prepare(ViewerState state) {
  if (photographs_ && !state.photograph.empty() && PhotographOf(state) == nullptr) {
    state.message = "there is no photograph " + state.photograph + " with a pose";
    state.photograph.clear();
  }
  if (!Compares(state)) return state;
  try {
    photographs_->Compare(*PhotographOf(state), drawn_, state);
  } catch (const Error& error) {
    state.message = error.what();
    state.show_photograph = false;
  }
  return state;
}

void SceneView::Draw(const ViewerState& state, PictureSize size) {
  if (Compares(state)) {
    photographs_->Draw(size.width, size.height, state.background);
    return;
  }
  const PosedCamera posed = CameraOf(state, size);
  Sphere bounds = drawn_.bounds();
  if (state.show_cameras && photographs_) {
    for (const PosedPhotograph& one : photographs_->photographs()) {
      bounds = SphereAround(bounds, {one.camera.camera_from_world.Center(), 2 * FrustumDepth()});
    }
  }
  const GlView view = ViewOf(bounds, posed.camera, posed.camera_from_world);
  ClearPicture(state.background, 1);
  if (state.overlay != Overlay::kNone) {
    DrawOverlay(state, view);
  } else {
    drawn_.DrawInto(view, MakeGlRenderOptions(state));
  }
  DrawLines(state, view);
}

void SceneView::Report(const ViewerState& state, ViewerStatus& status) const {
  status.models.clear();
  for (const PlacedModel& placed : scene_) status.models.push_back(placed.name);
  status.triangles = mesh_.triangles.size();
  status.loading_share = loader_ ? std::min(loader_->Share(), 0.99) : 1;
  status.loading_what = loader_ ? loader_->What() : "";
  status.error = error_;
  status.photographs.clear();
  status.photograph_psnr_db.reset();
  if (photographs_) {
    for (const PosedPhotograph& one : photographs_->photographs()) {
      status.photographs.push_back(one.id);
    }
    status.photographs_have_pictures = photographs_->HasPictures();
    if (Compares(state)) {
      status.photograph_psnr_db = photographs_->difference().psnr_db;
      status.photograph_held_out = PhotographOf(state)->held_out;
    }
  }
  status.legend = state.overlay == Overlay::kNone ? std::vector<LegendEntry>() : marks_->legend;
  status.passes = drawn_.PassCount(MakeGlRenderOptions(state));
}

}  // namespace lfm
