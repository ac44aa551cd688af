// SPDX-License-Identifier: BSD-3-Clause
#include "viewer/scene_view.h"

#include <algorithm>
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
                      kTapeColor = {1, 0.35f, 0.3f};

// Angles give a rotation back but for rounding.
bool StandsThere(const Placement& a, const Placement& b) {
  return (a.world_from_model.rotation - b.world_from_model.rotation).norm() < 1e-9 &&
         a.world_from_model.translation == b.world_from_model.translation && a.scale == b.scale;
}

}  // namespace

SceneView::SceneView(const ViewOptions& options, BlockUse block_use)
    : options_(options), block_use_(block_use) {}

void SceneView::Load(std::vector<SceneEntry> entries) {
  Begin({std::move(entries), Dropped::kReplaces, false});
}

void SceneView::Begin(Loading load) {
  if (load.dropped == Dropped::kJoins && loader_) {  // what is being read is not lost
    waiting_.push_back(std::move(load));
    return;
  }
  if (load.dropped == Dropped::kReplaces) waiting_.clear();
  loader_.reset();  // waits for what it is reading
  error_.clear();
  more_errors_ = 0;
  entries_ = std::move(load.entries);
  places_.assign(entries_.size(), kNotShown);
  replace_ = load.dropped == Dropped::kReplaces;
  beside_ = load.beside;
  loader_ = std::make_unique<ModelLoader>(entries_);
}

void SceneView::LoadFiles(const std::vector<std::filesystem::path>& files, Dropped dropped) {
  std::vector<SceneEntry> entries;
  bool scenes = false;
  for (const std::filesystem::path& file : files) {
    scenes = scenes || IsSceneFile(file);
    const std::vector<SceneEntry> more = SceneEntriesOf(file);
    entries.insert(entries.end(), more.begin(), more.end());
  }
  const bool beside = !scenes && (dropped == Dropped::kJoins || files.size() > 1);
  Begin({std::move(entries), dropped, beside});
  others_ = others_ || dropped == Dropped::kReplaces;
}

bool SceneView::IsReading() const { return loader_ != nullptr; }

void SceneView::SayFault(const std::string& fault) {
  if (error_.empty()) {
    error_ = fault;
  } else {
    ++more_errors_;
  }
}

void SceneView::ShowPhotographsOf(const std::filesystem::path& work,
                                  const std::filesystem::path& capture) {
  photographs_ = std::make_unique<PhotographView>(work, capture);
}

ViewerState SceneView::TakeArrivals(ViewerState state) {
  if (!loader_) return state;
  bool changed = false;
  if (auto arrival = loader_->Next()) {  // one a frame: the window stays alive
    const PlacedModel& model = arrival->model;
    if (!arrival->note.empty()) {
      if (model.model) {
        state.message = arrival->note;
      } else {
        SayFault(arrival->note);
      }
    }
    if (model.model) {
      try {
        state = Put(std::move(state), *arrival);
        changed = true;
      } catch (const std::exception& error) {  // too large for this graphics card
        SayFault(model.name + ": " + error.what());
      }
    }
  }
  if (loader_->Done()) {
    loader_.reset();
    if (!waiting_.empty()) {
      Loading next = std::move(waiting_.front());
      waiting_.pop_front();
      Begin(std::move(next));
    }
  }
  return changed ? Rebuilt(std::move(state)) : state;
}

ViewerState SceneView::Put(ViewerState state, const ModelLoader::Arrival& arrival) {
  PlacedModel model = arrival.model;
  size_t& place = places_[arrival.entry];
  const size_t there = replace_ ? 0 : place == kNotShown ? scene_.size() : place;
  if (!replace_ && place != kNotShown) {
    model.placement = scene_[place].placement;
  } else if (beside_) {
    model.placement = PlaceBeside(replace_ ? Scene() : scene_, model.model->mesh);
  }
  if (replace_) {
    GlScene fresh;  // what is shown stays where this fails
    fresh.Put(0, model, block_use_);
    drawn_ = std::move(fresh);
    replace_ = false;
    scene_.clear();
    files_.clear();
    whole_.clear();
    state.tape.clear();
    state.touched = false;
    if (others_ && photographs_) {
      photographs_.reset();
      state.photograph.clear();
      state.message = "the photographs were of another model";
    }
  } else {
    drawn_.Put(there, model, block_use_);
  }
  if (there == scene_.size()) {
    scene_.emplace_back();
    files_.push_back(entries_[arrival.entry].file);
    whole_.push_back(false);
  }
  place = there;
  scene_[there] = std::move(model);
  whole_[there] = arrival.whole;
  return state;
}

ViewerState SceneView::Show(ViewerState state, const Scene& scene) {
  files_.resize(scene.size());
  whole_.assign(scene.size(), true);
  loader_.reset();
  error_.clear();
  scene_ = scene;
  drawn_ = GlScene(scene, block_use_);
  return Rebuilt(std::move(state));
}

ViewerState SceneView::Rebuilt(ViewerState state) {
  mesh_ = SceneMesh(scene_);
  rays_.reset();
  overlay_.Clear();
  if (photographs_) photographs_->SceneChanged();
  int terms = 0;
  state.models.clear();
  for (size_t i = 0; i < scene_.size(); ++i) {
    terms = std::max(terms, scene_[i].model->terms);
    // What terms were wanted is not forgotten while only mean views are there.
    if (!whole_[i]) terms = std::max(terms, state.model_terms);
    state.models.push_back(ShownAt(scene_[i].name, files_[i], scene_[i].placement));
  }
  return WithScene(std::move(state), mesh_, terms, options_, SmallestRadius(scene_));
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
  overlay_.Recolor();
  state.tape.clear();
  if (photographs_) photographs_->SceneChanged();
  state.touched = true;  // nothing jumps while something is moved
  return WithScene(std::move(state), mesh_, state.model_terms, options_, SmallestRadius(scene_));
}

const PosedPhotograph* SceneView::PhotographOf(const ViewerState& state) const {
  return photographs_ ? photographs_->Find(state.photograph) : nullptr;
}

PosedCamera SceneView::InScene(PosedCamera camera) const {
  if (scene_.empty()) return camera;
  const Placement& placement = scene_.front().placement;
  Pose& pose = camera.camera_from_world;  // lengths by scale: the picture is the same
  pose.translation *= placement.scale;
  pose = pose * placement.world_from_model.Inverse();
  return camera;
}

std::vector<PosedPhotograph> SceneView::PhotographsInScene() const {
  std::vector<PosedPhotograph> photographs = photographs_->photographs();
  for (PosedPhotograph& one : photographs) one.camera = InScene(one.camera);
  return photographs;
}

double SceneView::FrustumDepth() const { return kFrustumShare * drawn_.bounds().radius; }

PosedCamera SceneView::CameraOf(const ViewerState& state, PictureSize size) const {
  if (const PosedPhotograph* photograph = PhotographOf(state)) {
    return {CameraInWindow(photograph->camera.camera, size.width, size.height),
            InScene(photograph->camera).camera_from_world};
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
    // The click before it was no end of the tape.
    if (state.tool == Tool::kMeasure && !state.tape.empty()) state.tape.pop_back();
    return FocusOn(std::move(state), *point);
  }
  if (state.tool == Tool::kMeasure) {
    if (point) return AddTapeEnd(std::move(state), *point);
    state.message = "the tape holds to the surface alone; click on the object";
    return state;
  }
  if (state.show_cameras && photographs_) {
    const std::vector<PosedPhotograph> photographs = PhotographsInScene();
    const int picked = PickFrustum(photographs, FrustumDepth(), camera.camera,
                                   camera.camera_from_world, pixel, kClickReach);
    if (picked >= 0) state.photograph = photographs[picked].id;
  }
  return state;
}

// The model was made without the held-out ones.
std::vector<int> SceneView::CountUsedPhotographs() const {
  if (!photographs_) return {};
  std::vector<PosedCamera> cameras;
  for (const PosedPhotograph& one : photographs_->photographs()) {
    if (!one.held_out) cameras.push_back(one.camera);
  }
  return CountPhotographs(scene_.front().model->mesh, cameras, SilentProgress());
}

void SceneView::DrawLines(const ViewerState& state, const GlView& view) const {
  if (photographs_ && state.show_cameras) {
    std::vector<Eigen::Vector3d> used, held_out;
    for (const PosedPhotograph& photograph : PhotographsInScene()) {
      if (photograph.id == state.photograph) continue;  // one does not see one's own
      const auto lines = FrustumLines(photograph.camera, FrustumDepth());
      std::vector<Eigen::Vector3d>& list = photograph.held_out ? held_out : used;
      list.insert(list.end(), lines.begin(), lines.end());
    }
    lines_.DrawInto(view, used, kCameraColor, LineDepth::kFaintBehind);
    lines_.DrawInto(view, held_out, kHeldOutColor, LineDepth::kFaintBehind);
  }
  if (state.tape.size() == 2) {
    lines_.DrawInto(view, state.tape, kTapeColor, LineDepth::kFaintBehind);
  }
  // A cross at each end, as large everywhere in the picture.
  for (const Eigen::Vector3d& end : state.tape) {
    const double arm = 8 * (view.camera_from_world * end).z() / view.camera.fx;
    std::vector<Eigen::Vector3d> cross;
    for (int axis = 0; axis < 3; ++axis) {
      cross.push_back(end - arm * Eigen::Vector3d::Unit(axis));
      cross.push_back(end + arm * Eigen::Vector3d::Unit(axis));
    }
    lines_.DrawInto(view, cross, kTapeColor, LineDepth::kFaintBehind);
  }
}

bool SceneView::Compares(const ViewerState& state) const {
  return state.show_photograph && PhotographOf(state) != nullptr && photographs_->HasPictures() &&
         drawn_.size() > 0;
}

// Whether the eye of any photograph's camera is in a square picture from there.
bool SceneView::SeesCameras(const ViewerState& state) const {
  constexpr PictureSize kAnySize = {1000, 1000};
  const PosedCamera from = CameraOf(state, kAnySize);
  for (const PosedPhotograph& one : PhotographsInScene()) {
    const auto pixel =
        Project(from.camera, from.camera_from_world * one.camera.camera_from_world.Center());
    if (pixel && from.camera.Contains(*pixel)) return true;
  }
  return false;
}

ViewerState SceneView::Prepare(ViewerState state) {
  if (photographs_ && !state.photograph.empty() && PhotographOf(state) == nullptr) {
    state.message = "there is no photograph " + state.photograph + " with a pose";
    state.photograph.clear();
  }
  if (const PosedPhotograph* photograph = PhotographOf(state);
      photograph != nullptr && standing_at_ != photograph->id) {
    const PosedCamera camera =
        InScene(photograph->camera);  // what turns, films and paths start from
    state.camera = OrbitLike(camera.camera, camera.camera_from_world, state.home);
  }
  standing_at_ = state.photograph;
  if (state.show_cameras && !cameras_shown_ && photographs_ && !SeesCameras(state)) {
    state.message = "the cameras stand behind you; scroll out to see them";
  }
  cameras_shown_ = state.show_cameras;
  if (!Compares(state)) return state;
  try {
    const PosedPhotograph& photograph = *PhotographOf(state);
    photographs_->Compare(photograph, InScene(photograph.camera).camera_from_world, drawn_, state);
  } catch (const Error& error) {
    state.message = error.what();
    state.show_photograph = false;
  }
  return state;
}

void SceneView::Draw(const ViewerState& state, PictureSize size, int left) {
  if (Compares(state)) {
    constexpr double kMostCovered = 0.5;
    photographs_->Draw(left < kMostCovered * size.width ? left : 0, size.width, size.height,
                       state.background);
    return;
  }
  const PosedCamera posed = CameraOf(state, size);
  Sphere bounds = drawn_.bounds();
  if (state.show_cameras && photographs_) {
    for (const PosedPhotograph& one : PhotographsInScene()) {
      bounds = SphereAround(bounds, {one.camera.camera_from_world.Center(), 2 * FrustumDepth()});
    }
  }
  const GlView view = ViewOf(bounds, posed.camera, posed.camera_from_world);
  ClearPicture(state.background, 1);
  if (state.overlay != Overlay::kNone) {
    overlay_.DrawInto(view, scene_, state.overlay, state.edges,
                      [this] { return CountUsedPhotographs(); });
  } else {
    drawn_.DrawInto(view, MakeGlRenderOptions(state));
  }
  DrawLines(state, view);
}

ViewerStatus SceneView::Report(const ViewerState& state, ViewerStatus status) const {
  status.models.clear();
  for (const PlacedModel& placed : scene_) status.models.push_back(placed.name);
  status.triangles = mesh_.triangles.size();
  status.loading_share = loader_ ? std::min(loader_->Share(), 0.99) : 1;
  status.loading_what = loader_ ? loader_->What() : "";
  status.error = error_;
  if (more_errors_ > 0) {
    status.error += " (and " + std::to_string(more_errors_) + " more could not be shown)";
  }
  status.photographs.clear();
  status.photograph_psnr_db.reset();
  if (photographs_) {
    for (const PosedPhotograph& one : photographs_->photographs()) {
      status.photographs.push_back(one.id);
    }
    status.photographs_have_pictures = photographs_->HasPictures();
    if (Compares(state) && photographs_->difference().pixels > 0) {
      status.photograph_psnr_db = photographs_->difference().psnr_db;
      status.photograph_held_out = PhotographOf(state)->held_out;
    }
  }
  status.legend = state.overlay == Overlay::kNone ? std::vector<LegendEntry>() : overlay_.legend();
  status.passes = drawn_.PassCount(MakeGlRenderOptions(state));
  return status;
}

}  // namespace lfm
