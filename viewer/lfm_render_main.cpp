// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "core/command_line.h"
#include "core/error.h"
#include "core/image.h"
#include "core/progress.h"
#include "encode/transport_form.h"
#include "viewer/camera_file.h"
#include "viewer/orbit_camera.h"
#include "viewer/reference_renderer.h"
#include "viewer/view_options.h"

namespace {

struct RenderCommandOptions {
  int turntable = 0;
  std::string camera;
  std::string work;
  std::string photo;
  int supersample = 2;
  bool alpha = false;
  void Declare(lfm::OptionVisitor& v) {
    v.Integer({"turntable", "Render this many frames of a full turn into the folder OUT.", "frames",
               0, 100000},
              turntable);
    v.Text({"camera", "Render from the camera in this JSON file (docs/formats.md)."}, camera);
    v.Text({"work", "A pipeline's working folder: render from one of its photographs' cameras."},
           work);
    v.Text({"photo", "With --work: the photograph's id."}, photo);
    v.Integer({"supersample", "Rays a pixel, squared: smoother edges against time.", "", 1, 16},
              supersample);
    v.Flag({"alpha", "Write the object alone, RGBA with straight alpha (PNG only)."}, alpha);
  }
};

void CheckUsage(const RenderCommandOptions& options, const std::filesystem::path& out) {
  if (options.work.empty() != options.photo.empty()) {
    throw lfm::Error("--work and --photo belong together; give both or none");
  }
  const int sources = (options.turntable > 0) + !options.camera.empty() + !options.work.empty();
  if (sources > 1) {
    throw lfm::Error("--turntable, --camera and --work exclude each other; give one of them");
  }
  const std::string ending = out.extension().string();
  if (options.turntable == 0 && ending != ".png" && (options.alpha || ending != ".jpg")) {
    throw lfm::Error("cannot write " + out.string() +
                     ": the picture's name must end in .png, or .jpg without --alpha");
  }
  if (options.turntable > 0 && std::filesystem::exists(out) &&
      !std::filesystem::is_directory(out)) {
    throw lfm::Error(out.string() + " is a file and --turntable needs a folder; name another");
  }
}

std::vector<lfm::PosedCamera> ChooseCameras(const lfm::TriangleMesh& mesh,
                                            const lfm::ViewOptions& view,
                                            const RenderCommandOptions& options) {
  if (!options.camera.empty()) return {lfm::ReadCameraFile(options.camera)};
  if (!options.work.empty()) return {lfm::PhotoCamera(options.work, options.photo)};
  const lfm::PictureSize size = lfm::ParsePictureSize(view.size);
  std::vector<lfm::PosedCamera> cameras;
  const lfm::OrbitCamera start = lfm::MakeOrbitCamera(mesh, view);
  for (const lfm::OrbitCamera& camera : lfm::TurntablePath(start, std::max(options.turntable, 1))) {
    cameras.push_back(
        {lfm::PinholeCamera(camera, size.width, size.height), lfm::CameraFromWorld(camera)});
  }
  return cameras;
}

/// A turntable is counted in frames; the rows of one frame only look out for Ctrl-C.
class RowsOfAFrame : public lfm::Progress {
 public:
  void Start(std::string_view, int64_t) override {}
  void Advance(int64_t) override {
    if (lfm::InterruptRequested()) throw lfm::Interrupted();
  }
  void Note(std::string_view) override {}
};

std::filesystem::path FramePath(const std::filesystem::path& folder, size_t frame) {
  char name[32];
  std::snprintf(name, sizeof(name), "frame_%04zu.png", frame);
  return folder / name;
}

}  // namespace

int main(int argc, char** argv) {
  std::string model_file, out;
  lfm::ViewOptions view;
  RenderCommandOptions options;
  lfm::CommandLine command("lfm-render",
                           "Renders a model without a display: one picture, a turntable, or the "
                           "view of a given camera.",
                           "lfm-render demo/work/encode/model.glb bust.png --azimuth 30");
  command.Positional("MODEL", "The model, a .glb, .lfz or .wrl file.", model_file);
  command.Positional("OUT", "The picture to write (.png); with --turntable, a folder.", out);
  command.Options(lfm::AnyOptions(view), "View");
  command.Options(lfm::AnyOptions(options), "Output");
  return command.Run(argc, argv, [&](lfm::Progress& progress) {
    CheckUsage(options, out);
    lfm::RenderOptions render;
    render.evaluation = lfm::MakeEvaluationOptions(view);
    render.samples_per_side = options.supersample;
    render.background = lfm::ParseColor(view.background);
    lfm::DecodedModel decoded = lfm::ReadModel(model_file);
    if (decoded.parts_missing > 0) progress.Note(lfm::CutOffNote(model_file, decoded));
    const lfm::ReferenceRenderer renderer(std::move(decoded.model));
    const std::vector<lfm::PosedCamera> cameras =
        ChooseCameras(renderer.model().mesh, view, options);
    const auto render_one = [&](const lfm::PosedCamera& camera, const std::filesystem::path& file,
                                lfm::Progress& rows) {
      const lfm::Rendering rendering =
          renderer.Render(camera.camera, camera.camera_from_world, render, rows);
      lfm::WriteImage(options.alpha ? rendering.layer : rendering.color, file);
    };
    if (options.turntable == 0) {
      render_one(cameras[0], out, progress);
      return;
    }
    RowsOfAFrame rows;
    progress.Start("render the turntable", static_cast<int64_t>(cameras.size()));
    for (size_t i = 0; i < cameras.size(); ++i) {
      render_one(cameras[i], FramePath(out, i), rows);
      progress.Advance();
    }
  });
}
