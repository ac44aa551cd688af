// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "core/atomic_file.h"
#include "core/command_line.h"
#include "core/error.h"
#include "core/image.h"
#include "core/progress.h"
#include "encode/glb.h"
#include "viewer/camera_file.h"
#include "viewer/camera_path.h"
#include "viewer/gl_pictures.h"
#include "viewer/orbit_camera.h"
#include "viewer/reference_renderer.h"
#include "viewer/scene.h"
#include "viewer/scene_reading.h"
#include "viewer/view_options.h"
#include "viewer/web_page.h"

namespace {

enum class Renderer { kCpu, kGl };

struct RenderCommandOptions {
  Renderer renderer = Renderer::kCpu;
  lfm::ViewCoordinates view_coordinates = lfm::ViewCoordinates::kPerPixel;
  int turntable = 0;
  std::string path;
  std::string camera;
  std::string work;
  std::string photo;
  int supersample = 2;
  bool alpha = false;
  bool web = false;
  void Declare(lfm::OptionVisitor& v) {
    v.Enumeration({"renderer",
                   "The reference, which casts rays and knows every lens (cpu), or OpenGL without "
                   "a display, which draws pinhole pictures faster (gl)."},
                  {"cpu", "gl"}, renderer);
    lfm::DeclareViewCoordinates(v, view_coordinates);
    v.Integer({"turntable", "Render this many frames of a full turn into the folder OUT.", "frames",
               0, 100000},
              turntable);
    v.Text({"path",
            "Render the film of this camera path (JSON, docs/formats.md) into the folder "
            "OUT."},
           path);
    v.Text({"camera", "Render from the camera in this JSON file (docs/formats.md)."}, camera);
    v.Text({"work",
            "A pipeline's working folder: render from its photographs' cameras, all of them into "
            "the folder OUT, or one with --photo."},
           work);
    v.Text({"photo", "With --work: the photograph's id."}, photo);
    v.Integer({"supersample", "Samples a pixel, squared: smoother edges against time.", "", 1, 16},
              supersample);
    v.Flag({"alpha", "Write the object alone: RGBA, straight alpha in PNG, associated in EXR."},
           alpha);
    v.Flag({"web",
            "Write the model for browsers: OUT is a folder with model.html, which opens from disk, "
            "and index.html for a web server."},
           web);
  }
  /// Whether OUT is a folder of many pictures.
  bool WritesFolder() const {
    return turntable > 0 || !path.empty() || (!work.empty() && photo.empty());
  }
};

void CheckUsage(const RenderCommandOptions& options, const std::filesystem::path& out) {
  if (options.work.empty() && !options.photo.empty()) {
    throw lfm::Error("--photo names a photograph of --work; give both");
  }
  if (options.renderer == Renderer::kCpu &&
      options.view_coordinates != lfm::ViewCoordinates::kPerPixel) {
    throw lfm::Error("--view-coordinates is of --renderer gl; give both");
  }
  const int sources = (options.turntable > 0) + !options.path.empty() + !options.camera.empty() +
                      !options.work.empty();
  if (sources > 1) {
    throw lfm::Error("--turntable, --path, --camera and --work exclude each other; give one");
  }
  if (options.web && (sources > 0 || options.alpha)) {
    throw lfm::Error("--web writes pages, no pictures; leave the other options of Output out");
  }
  const bool folder = options.web || options.WritesFolder();
  if (folder && std::filesystem::exists(out) && !std::filesystem::is_directory(out)) {
    throw lfm::Error(out.string() + " is a file and a folder is to be written; name another");
  }
  const std::string ending = out.extension().string();
  if (folder && (ending == ".png" || ending == ".exr" || ending == ".jpg")) {
    throw lfm::Error(out.string() +
                     ": a folder is to be written; name one, or add --photo for one picture");
  }
  if (!folder && ending != ".png" && ending != ".exr" && (options.alpha || ending != ".jpg")) {
    throw lfm::Error("cannot write " + out.string() +
                     ": the picture's name must end in .png or .exr, or .jpg without --alpha");
  }
}

/// A picture to be made.
struct Shot {
  lfm::PosedCamera camera;
  std::filesystem::path file;
};

std::filesystem::path FramePath(const std::filesystem::path& folder, size_t frame) {
  char name[32];
  std::snprintf(name, sizeof(name), "frame_%04zu.png", frame);
  return folder / name;
}

std::vector<Shot> PhotographShots(const RenderCommandOptions& options,
                                  const std::filesystem::path& out) {
  if (!options.photo.empty()) return {{lfm::PhotoCamera(options.work, options.photo), out}};
  std::vector<Shot> shots;
  for (const auto& [id, camera] : lfm::PhotoCameras(options.work)) {
    shots.push_back({camera, out / (id + ".png")});
  }
  return shots;
}

std::vector<Shot> PlanShots(const lfm::TriangleMesh& mesh, const lfm::ViewOptions& view,
                            const RenderCommandOptions& options, const std::filesystem::path& out) {
  if (!options.camera.empty()) return {{lfm::ReadCameraFile(options.camera), out}};
  if (!options.work.empty()) return PhotographShots(options, out);
  const lfm::PictureSize size = lfm::ParsePictureSize(view.size);
  const lfm::OrbitCamera start = lfm::MakeOrbitCamera(mesh, view);
  std::vector<lfm::OrbitCamera> cameras = {start};
  if (options.turntable > 0) cameras = lfm::TurntablePath(start, options.turntable);
  if (!options.path.empty()) cameras = lfm::FramesOf(lfm::ReadCameraPath(options.path, start));
  std::vector<Shot> shots;
  for (const lfm::OrbitCamera& camera : cameras) {
    shots.push_back(
        {{lfm::PinholeCamera(camera, size.width, size.height), lfm::CameraFromWorld(camera)},
         options.WritesFolder() ? FramePath(out, shots.size()) : out});
  }
  return shots;
}

/// Before the first picture is drawn.
void RequirePinholes(const std::vector<Shot>& shots) {
  for (const Shot& shot : shots) {
    if (!shot.camera.camera.HasDistortion()) continue;
    throw lfm::Error(shot.file.string() +
                     ": its camera's lens distorts, and OpenGL draws pinhole pictures; leave "
                     "--renderer gl out");
  }
}

/// That --term-alone names one that there is to see.
void RequireTerm(const lfm::Scene& scene, const lfm::ViewOptions& view) {
  if (view.term_alone == 0) return;
  if (view.mean_only) throw lfm::Error("--term-alone and --mean-only exclude each other; give one");
  int most = 0;
  for (const lfm::PlacedModel& placed : scene) most = std::max(most, placed.model->terms);
  if (view.term_alone > most) {
    throw lfm::Error("--term-alone " + std::to_string(view.term_alone) + ": there are " +
                     std::to_string(most) + " terms; choose one of them");
  }
}

using RenderFunction = std::function<lfm::Rendering(const lfm::PosedCamera&, lfm::Progress&)>;

/// Either renderer, behind one call.
RenderFunction MakeRenderer(const lfm::Scene& scene, const RenderCommandOptions& command,
                            const lfm::RenderOptions& options) {
  if (command.renderer == Renderer::kGl) {
    const auto gl = std::make_shared<lfm::GlPictures>(scene, command.view_coordinates);
    return [gl, options](const lfm::PosedCamera& posed, lfm::Progress& rows) {
      return gl->Render(posed.camera, posed.camera_from_world, options, rows);
    };
  }
  const auto cpu = std::make_shared<lfm::ReferenceRenderer>(scene);
  return [cpu, options](const lfm::PosedCamera& posed, lfm::Progress& rows) {
    return cpu->Render(posed.camera, posed.camera_from_world, options, rows);
  };
}

const lfm::Image& PictureOf(const lfm::Rendering& rendering, const std::filesystem::path& file,
                            bool alpha) {
  if (file.extension() == ".exr") return alpha ? rendering.linear_layer : rendering.linear_color;
  return alpha ? rendering.layer : rendering.color;
}

/// Many pictures are counted one by one; the rows of one frame only look out for Ctrl-C.
class RowsOfAFrame : public lfm::Progress {
 public:
  void Start(std::string_view, int64_t) override {}
  void Advance(int64_t) override {
    if (lfm::InterruptRequested()) throw lfm::Interrupted();
  }
  void Note(std::string_view) override {}
};

/// Pages replace pages, and nothing else: a file of one of their names in a folder without pages is
/// somebody's, and what is read is never replaced, but by one model that is written as it was.
void RequireNothingOfOthers(const std::filesystem::path& model_or_scene,
                            const std::vector<lfm::SceneEntry>& entries,
                            const std::filesystem::path& out) {
  std::error_code absent;
  const bool has_pages = std::filesystem::exists(out / "model.html", absent);
  std::vector<std::string> names = {"index.html", "app.js", "scene.json", "model.glb"};
  for (size_t i = 2;; ++i) {  // those beyond are removed
    names.push_back("model-" + std::to_string(i) + ".glb");
    if (i > entries.size() && !std::filesystem::exists(out / names.back(), absent)) break;
  }
  for (const std::string& name : names) {
    const std::filesystem::path there = out / name;
    if (!std::filesystem::exists(there, absent)) continue;
    bool is_input = std::filesystem::equivalent(model_or_scene, there, absent);
    for (const lfm::SceneEntry& entry : entries) {
      is_input = is_input || std::filesystem::equivalent(entry.file, there, absent);
    }
    const bool stays = entries.size() == 1 && is_input && name == "model.glb";
    if (is_input ? !stays : !has_pages) {
      throw lfm::Error(there.string() +
                       (is_input                      ? " is read, and"
                        : there.extension() == ".glb" ? " is another model, which"
                                                      : " is somebody else's, which") +
                       " --web would replace; name another folder");
    }
  }
}

/// A model's file as it is where it is a .glb, else written as one.
std::string GlbOf(const lfm::SceneEntry& entry, const lfm::LightFieldModel& model) {
  return entry.file.extension() == ".glb" ? lfm::ReadFile(entry.file) : lfm::GlbBytes(model);
}

/// What is no model is an Error.
void WriteForBrowsers(const std::filesystem::path& model_or_scene, const std::filesystem::path& out,
                      lfm::Progress& progress) {
  progress.Start("write the pages", 1);
  const std::vector<lfm::SceneEntry> entries = lfm::SceneEntriesOf(model_or_scene);
  const lfm::Scene scene = lfm::ReadScene(entries, progress);
  RequireNothingOfOthers(model_or_scene, entries, out);
  std::map<std::filesystem::path, std::string> files;
  std::vector<lfm::WebModel> models;
  for (size_t i = 0; i < entries.size(); ++i) {
    std::string& glb = files[entries[i].file];
    if (glb.empty()) glb = GlbOf(entries[i], *scene[i].model);
    models.push_back({glb, entries[i].placement});
  }
  lfm::WriteWebFolder(models, model_or_scene.stem().string(), out);
  progress.Advance();
}

}  // namespace

int main(int argc, char** argv) {
  std::string model_file, out;
  lfm::ViewOptions view;
  RenderCommandOptions options;
  lfm::CommandLine command(
      "lfm-render",
      "Renders a model without a display: one picture, a turntable, a film, or "
      "the views of given cameras; or writes it for browsers (--web).",
      "lfm-render demo/work/encode/model.glb bust.png --azimuth 30");
  command.Positional(
      "MODEL", "The model, a .glb, .lfz or .wrl file; or a scene, a .json file (docs/formats.md).",
      model_file);
  command.Positional(
      "OUT",
      "The picture to write (.png, .exr, .jpg); a folder with --turntable, --path, --web, and "
      "with --work for all photographs.",
      out);
  command.Options(lfm::AnyOptions(view), "View");
  command.Options(lfm::AnyOptions(options), "Output");
  return command.Run(argc, argv, [&](lfm::Progress& progress) {
    CheckUsage(options, out);
    if (options.web) {
      for (const char* name :
           {"azimuth", "elevation", "distance", "fov", "size", "background", "terms", "mean-only",
            "term-alone", "exposure", "tone", "renderer", "view-coordinates", "supersample"}) {
        if (command.Given(name)) {
          throw lfm::Error(
              std::string("--") + name +
              " has no effect with --web, whose pages are turned by hand; leave it out");
        }
      }
      return WriteForBrowsers(model_file, out, progress);
    }
    lfm::RenderOptions render;
    render.evaluation = lfm::MakeEvaluationOptions(view);
    render.tone = lfm::MakeTone(view);
    render.samples_per_side = options.supersample;
    render.background = lfm::ParseColor(view.background);
    render.linear_light = std::filesystem::path(out).extension() == ".exr";
    const lfm::Scene scene = lfm::ReadScene(lfm::SceneEntriesOf(model_file), progress);
    RequireTerm(scene, view);
    const std::vector<Shot> shots = PlanShots(lfm::SceneMesh(scene), view, options, out);
    if (options.renderer == Renderer::kGl) RequirePinholes(shots);
    const RenderFunction renderer = MakeRenderer(scene, options, render);
    const auto render_one = [&](const Shot& shot, lfm::Progress& rows) {
      const lfm::Rendering rendering = renderer(shot.camera, rows);
      lfm::WriteImage(PictureOf(rendering, shot.file, options.alpha), shot.file);
    };
    if (!options.WritesFolder()) return render_one(shots.at(0), progress);
    RowsOfAFrame rows;
    progress.Start("render", static_cast<int64_t>(shots.size()));
    for (const Shot& shot : shots) {
      render_one(shot, rows);
      progress.Advance();
    }
  });
}
