// SPDX-License-Identifier: BSD-3-Clause
#include "viewer/viewer_app.h"

#include <chrono>
#include <exception>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <utility>

#include "core/error.h"
#include "core/image.h"
#include "core/json_reader.h"
#include "core/progress.h"
#include "viewer/camera_path.h"
#include "viewer/film_recorder.h"
#include "viewer/gl_framebuffer.h"
#include "viewer/scene_reading.h"
#include "viewer/scene_view.h"
#include "viewer/viewer_input.h"
#include "viewer/viewer_panel.h"
#include "viewer/viewer_script.h"
#include "viewer/viewer_settings.h"
#include "viewer/viewer_state.h"
#include "viewer/window.h"

namespace lfm {
namespace {

constexpr size_t kFrameTimes = 120;
constexpr int kFramesAfterEvents = 3;  // the panel settles
constexpr double kIdleSeconds = 0.2;

/// The same picture twice: with many samples to draw into, and smoothed.
struct Canvas {
  Canvas(PictureSize s, int samples)
      : size(s), drawn(s.width, s.height, samples), smooth(s.width, s.height, 1) {}
  PictureSize size;
  GlFramebuffer drawn, smooth;
};

class App {
 public:
  App(const std::filesystem::path& model_or_scene, const ViewOptions& view,
      const ViewerOptions& options, Progress& progress)
      : options_(options), state_(MakeViewerState(view)) {
    state_.edges = options.wireframe ? EdgeOverlay::kWireframe : EdgeOverlay::kNone;
    state_.view_coordinates = options.view_coordinates;
    if (!options.script.empty()) script_.emplace(ReadViewerScript(options.script));
    const std::vector<SceneEntry> entries = SceneEntriesOf(model_or_scene);
    const bool screenshot = !options.screenshot.empty();
    Scene read;  // nobody is there to see a window fill
    if (screenshot) read = ReadScene(entries, progress);
    const bool hidden = screenshot || script_.has_value();
    window_ =
        std::make_unique<Window>("lfm-viewer", ParsePictureSize(view.size),
                                 hidden ? WindowVisibility::kHidden : WindowVisibility::kShown);
    RequireGl33();
    panel_ = std::make_unique<ViewerPanel>(
        *window_, options.ui_scale > 0 ? options.ui_scale : window_->ContentScale());
    scene_ = std::make_unique<SceneView>(view, options.block_use);
    if (!options.work.empty()) scene_->ShowPhotographsOf(options.work, options.capture);
    if (screenshot) {
      state_ = scene_->Show(std::move(state_), read);
    } else {
      scene_->Load(entries);
    }
  }

  void Run() {
    if (!options_.screenshot.empty()) {
      RunScreenshot();
      return;
    }
    while (!window_->ShouldClose() && !state_.quit) {
      RequireNoInterrupt();
      Frame();
      if (!script_) Rest();
    }
  }

 private:
  static void RequireNoInterrupt() {
    if (InterruptRequested()) throw Interrupted();
  }

  void RunScreenshot() {
    for (int frame = 0; frame < options_.frames; ++frame) {
      RequireNoInterrupt();
      Frame();
    }
    SavePicture(options_.screenshot, options_.with_panel);
  }

  void TakeArrivals() {
    state_ = scene_->TakeArrivals(std::move(state_));
    status_ = scene_->Report(state_, std::move(status_));
    // Nobody would read it in the window; what a script drops is its own affair.
    if (script_ && !status_.error.empty() && !dropped_any_) throw Error(status_.error);
  }

  void Frame() {
    const PictureSize size = window_->FramebufferSize();
    PlayRequest();
    TakeDropped();
    TakeArrivals();
    std::optional<ScriptedInput> hands;
    if (script_) hands = script_->NextFrame();
    if (size.width < 1 || size.height < 1) {  // minimised
      if (canvas_) RecordFilm();
      window_->WaitForEvents(script_ ? 0.01 : kIdleSeconds);
      return;
    }
    const auto begin = std::chrono::steady_clock::now();
    if (!canvas_ || canvas_->size.width != size.width || canvas_->size.height != size.height) {
      canvas_ = std::make_unique<Canvas>(size, options_.multisample);
    }
    status_.film_share = film_.Share();
    state_ = panel_->Update(std::move(state_), status_, hands);
    state_ = scene_->PlaceModels(std::move(state_));
    if (state_.click) state_ = scene_->ApplyClick(std::move(state_), size);
    state_ = scene_->Prepare(std::move(state_));
    if (!RecordFilm()) DrawScene(state_);
    DoRequests();
    ShowPanel();
    window_->SwapAndPoll();
    NoteFrameTime(
        std::chrono::duration<float, std::milli>(std::chrono::steady_clock::now() - begin).count());
  }

  void DrawScene(const ViewerState& state) {
    canvas_->drawn.Bind();
    scene_->Draw(state, canvas_->size,
                 static_cast<int>(panel_->CoveredShare() * canvas_->size.width));
    canvas_->drawn.ResolveInto(canvas_->smooth);
  }

  void ShowPanel() {
    if (script_ || !options_.screenshot.empty()) plain_ = canvas_->smooth.Read();
    canvas_->smooth.Bind();
    panel_->Draw();
    canvas_->smooth.CopyToWindow();
  }

  void SavePicture(const std::filesystem::path& file, bool with_panel) {
    if (!canvas_) throw Error(file.string() + ": the window has no picture to save");
    const bool kept = !with_panel && !plain_.empty();
    WriteImage(kept ? plain_ : canvas_->smooth.Read(), file);
  }

  // What the user asked for that ends within the frame. A full disk should not close the window.
  void DoRequests() {
    try {
      if (std::exchange(state_.save_screenshot, false)) {
        const std::filesystem::path file = FreeName("lfm-viewer-", ".png");
        WriteImage(canvas_->smooth.Read(), file);
        state_.message = "saved " + file.string();
      }
      if (std::exchange(state_.save_path, false)) {
        const std::filesystem::path file = FreeName("lfm-viewer-path-", ".json");
        WriteCameraPath(state_.path, file);
        state_.message = "saved " + file.string() + "; lfm-render --path makes a film of it";
      }
      if (std::exchange(state_.save_scene, false)) SaveScene();
      StartFilm();
    } catch (const std::exception& error) {
      state_.message = error.what();
    }
  }

  void SaveScene() {
    if (state_.models.empty()) throw Error("there is no model yet to save a scene of");
    std::vector<SceneEntry> entries;
    for (const ShownModel& model : state_.models) {
      entries.push_back({model.file, PlacementOf(model)});
    }
    const std::filesystem::path file = FreeName("lfm-viewer-scene-", ".json");
    WriteSceneFile(entries, file);
    state_.message = "saved " + file.string();
  }

  void StartFilm() {
    const Film film = std::exchange(state_.film, Film::kNone);
    if (film == Film::kNone) return;
    if (film == Film::kPath && state_.path.keys.empty()) {
      throw Error("the camera path has no place yet; add some (K)");
    }
    film_ = FilmRecorder(film == Film::kTurntable
                             ? TurntablePath(state_.camera, state_.turntable_frames)
                             : FramesOf(state_.path),
                         FreeName("lfm-viewer-film-", ""));
    film_view_ = state_;
    film_view_.photograph.clear();
  }

  // A frame of the film, as everything looked when it began; whether there was one.
  bool RecordFilm() {
    if (std::exchange(state_.stop_film, false) && !film_.Done()) {
      film_.Stop();
      state_.message = "stopped: " + film_.Summary();
    }
    if (film_.Done()) return false;
    film_view_.camera = film_.Camera();
    DrawScene(film_view_);
    try {
      film_.Record(canvas_->smooth.Read());
      if (film_.Done()) state_.message = film_.Summary();
    } catch (const std::exception& error) {
      film_.Stop();
      state_.message = error.what();
    }
    return true;
  }

  void TakeDropped() {
    const std::vector<std::filesystem::path> files = window_->TakeDropped();
    if (!files.empty()) Open(files);
  }

  void Open(const std::vector<std::filesystem::path>& files) {
    dropped_any_ = true;
    try {
      scene_->LoadFiles(files, state_.add_dropped ? Dropped::kJoins : Dropped::kReplaces);
    } catch (const std::exception& error) {
      state_.message = error.what();
    }
  }

  void PlayRequest() {
    if (!script_) return;
    const std::optional<ScriptStep> step = script_->Request(scene_->IsReading() || !film_.Done());
    if (!step) return;
    status_ = scene_->Report(state_, std::move(status_));  // as it was drawn last
    try {
      Play(*step);
    } catch (const Error& error) {
      throw Error(options_.script + ":" + std::to_string(step->line) + ": " + error.what(),
                  error.kind());
    }
  }

  void Play(const ScriptStep& step) {
    using Kind = ScriptStep::Kind;
    switch (step.kind) {
      case Kind::kDrop:
        return Open({step.text});
      case Kind::kResize:
        return window_->Resize(
            {static_cast<int>(step.numbers[0]), static_cast<int>(step.numbers[1])});
      case Kind::kScreenshot:
        return SavePicture(step.text, false);
      case Kind::kWindowshot:
        return SavePicture(step.text, true);
      case Kind::kSet:
        state_ = SetByName(std::move(state_), step.text);
        return;
      case Kind::kState:
        return WriteJson(StateToJson(state_, status_), step.text);
      case Kind::kQuit:
        state_.quit = true;
        return;
      default:  // hands
        return;
    }
  }

  void NoteFrameTime(float milliseconds) {
    status_.frame_times_ms.push_back(milliseconds);
    if (status_.frame_times_ms.size() > kFrameTimes) {
      status_.frame_times_ms.erase(status_.frame_times_ms.begin());
    }
  }

  // Nothing is drawn while nothing happens.
  void Rest() {
    if (scene_->IsReading() || !film_.Done() || state_.show_frame_times) {
      awake_ = kFramesAfterEvents;
      return;
    }
    if (awake_-- > 0) return;
    const auto begin = std::chrono::steady_clock::now();
    window_->WaitForEvents(kIdleSeconds);
    const std::chrono::duration<double> waited = std::chrono::steady_clock::now() - begin;
    awake_ = waited.count() < kIdleSeconds ? kFramesAfterEvents : 0;
  }

  ViewerOptions options_;
  ViewerState state_;
  ViewerStatus status_;
  std::optional<ScriptPlayer> script_;
  std::unique_ptr<Window> window_;  // before what lives in its context
  std::unique_ptr<ViewerPanel> panel_;
  std::unique_ptr<SceneView> scene_;
  std::unique_ptr<Canvas> canvas_;
  FilmRecorder film_;
  ViewerState film_view_;
  Image plain_;  ///< the last frame without its panel, where somebody may ask for it
  bool dropped_any_ = false;
  int awake_ = kFramesAfterEvents;
};

void CheckUsage(const std::filesystem::path& model_or_scene, const ViewerOptions& options) {
  const std::filesystem::path screenshot = options.screenshot;
  if (!screenshot.empty() && screenshot.extension() != ".png") {
    throw Error("cannot write " + screenshot.string() + ": a screenshot's name must end in .png");
  }
  if (!screenshot.empty() && !options.script.empty()) {
    throw Error("--screenshot and --script exclude each other; a script can save pictures");
  }
  if (options.work.empty() && !options.capture.empty()) {
    throw Error("--capture is of the photographs of --work; give both");
  }
  std::error_code problem;
  if (!std::filesystem::exists(model_or_scene, problem)) {
    throw Error("cannot open " + model_or_scene.string() + ": " +
                (problem ? problem.message() : "there is no such file"));
  }
}

}  // namespace

void RunViewer(const std::filesystem::path& model_or_scene, const ViewOptions& view,
               const ViewerOptions& options, Progress& progress) {
  CheckUsage(model_or_scene, options);
  App(model_or_scene, view, options, progress).Run();
}

}  // namespace lfm
