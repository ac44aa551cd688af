// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <system_error>
#include <vector>

#include "core/atomic_file.h"
#include "core/capture.h"
#include "core/command_line.h"
#include "core/error.h"
#include "core/image.h"
#include "core/progress.h"
#include "fields/light_sampling.h"
#include "fields/relightable_file.h"
#include "fields/relighting.h"
#include "viewer/light_plan.h"
#include "viewer/relight_page.h"
#include "viewer/tone.h"

namespace {

struct LightOptions {
  std::string environment;
  double rotate = 0;
  std::string light;
  double irradiance = 3.14159265358979;
  double light_radius = 0;
  double max_angle = 0;
  void Declare(lfm::OptionVisitor& v) {
    v.Text({"environment",
            "Light from all round: an equirectangular .hdr or .exr picture, +x in its middle, +y a "
            "quarter from its left edge, +z at its top."},
           environment);
    v.Number({"rotate", "Turn the surroundings about the vertical, counter-clockwise from above.",
              "deg", -3600, 3600},
             rotate);
    v.Text({"light",
            "A light from a direction: AZIMUTH,ELEVATION in degrees, or X,Y,Z; for a film several, "
            "with semicolons between them."},
           light);
    v.Number(
        {"irradiance",
         "Of the light, on a surface that faces it; with pi, white matte surfaces have radiance "
         "1.",
         "", 0, 1e30},
        irradiance);
    v.Number({"light-radius", "Angular radius of the light: soft shadows.", "deg", 0, 180},
             light_radius);
    v.Number({"max-angle",
              "Leave surroundings out that are further than this from every captured light; 0 cuts "
              "them off a cell's width outside a dome.",
              "deg", 0, 180},
             max_angle);
  }
};

struct PictureOptions {
  int residuals = -1;
  int frames = 0;
  double exposure = 0;
  bool auto_exposure = false;
  lfm::ToneCurve tone = lfm::ToneCurve::kClip;
  void Declare(lfm::OptionVisitor& v) {
    v.Integer({"residuals",
               "Use at most this many residuals a pixel and channel: sharper against time; -1 uses "
               "all.",
               "", -1, 65535},
              residuals);
    v.Integer({"frames",
               "Write a film of this many pictures into the folder OUT: surroundings make a full "
               "turn, the light goes through its directions, or a full turn where there is one.",
               "frames", 0, 100000},
              frames);
    v.Number({"exposure", "Brighter by this many stops (doublings of light).", "stops", -40, 40},
             exposure);
    v.Flag({"auto-exposure",
            "Bring 99 % of the first picture's values to white and below, before --exposure."},
           auto_exposure);
    v.Enumeration({"tone",
                   "Light beyond white: cut off (clip), or everything above four fifths rolled off "
                   "towards it (soft)."},
                  {"clip", "soft"}, tone);
  }
};

struct PageOptions {
  bool web = false;
  std::string capture;
  void Declare(lfm::OptionVisitor& v) {
    v.Flag({"web",
            "Write the model for browsers into the folder OUT, where light is moved by hand: "
            "relight.html, one file that opens from disk, and index.html for a web server."},
           web);
    v.Text({"capture",
            "The capture folder that the model is of: its camera tells the pages where in the "
            "picture light comes from. Without, x is to the right, y up, z towards the viewer."},
           capture);
  }
};

void CheckUsage(const LightOptions& light, const PictureOptions& picture,
                const std::filesystem::path& out) {
  if (light.environment.empty() && light.light.empty()) {
    throw lfm::Error("there is no light; give --environment, --light or both");
  }
  std::error_code absent;
  if (!light.environment.empty() && std::filesystem::equivalent(light.environment, out, absent)) {
    throw lfm::Error(out.string() + ": is the environment, which OUT would replace; name another");
  }
  const std::string ending = out.extension().string();
  const bool names_picture = ending == ".png" || ending == ".exr" || ending == ".jpg";
  if (picture.frames > 0) {
    if (names_picture ||
        (std::filesystem::exists(out, absent) && !std::filesystem::is_directory(out, absent))) {
      throw lfm::Error(out.string() + ": --frames writes a folder of pictures; name one");
    }
  } else if (!names_picture) {
    throw lfm::Error("cannot write " + out.string() +
                     ": the picture's name must end in .png, .exr or .jpg");
  }
}

/// The light of a frame over the model's directions.
class Lights {
 public:
  Lights(const lfm::RelightableModel& model, const LightOptions& options)
      : options_(options),
        channels_(model.channels),
        cells_(lfm::MakeLightCells(model.kind, model.directions, {options.max_angle})),
        triangulation_(lfm::TriangulateLights(model.directions)) {
    if (!options.environment.empty()) probe_ = lfm::ReadLightProbe(options.environment);
  }

  lfm::LightVector Of(const lfm::FrameLight& frame) const {
    lfm::LightVector light = lfm::MakeLightVector(static_cast<int>(cells_.directions.size()), 3);
    if (probe_) light = lfm::SampleProbe(cells_, *probe_, frame.turn_deg);
    light = lfm::WithChannels(light, channels_);
    if (!frame.to_light) return light;
    const lfm::LightVector lamp = lfm::WithChannels(
        lfm::SampleCap(cells_, triangulation_, *frame.to_light, options_.light_radius), channels_);
    for (size_t i = 0; i < light.values.size(); ++i) {
      light.values[i] += static_cast<float>(options_.irradiance) * lamp.values[i];
    }
    return light;
  }

 private:
  LightOptions options_;
  int channels_;
  lfm::LightCells cells_;
  lfm::LightTriangulation triangulation_;
  std::optional<lfm::LightProbe> probe_;
};

/// The stops that bring 99 % of the values to 1 and below; 0 for a black picture.
double StopsToWhite(const lfm::Image& linear) {
  std::vector<float> values(linear.Data<float>(), linear.Data<float>() + linear.size());
  const auto place = values.begin() + static_cast<std::ptrdiff_t>((values.size() - 1) * 0.99);
  std::nth_element(values.begin(), place, values.end());
  return *place > 0 ? -std::log2(double{*place}) : 0;
}

void RequireFinitePicture(const lfm::Image& linear) {
  const float* values = linear.Data<float>();
  if (!std::all_of(values, values + linear.size(), [](float v) { return std::isfinite(v); })) {
    throw lfm::Error(
        "the light is too strong for this model: the picture is not finite; lower --irradiance, "
        "or darken the environment");
  }
}

std::filesystem::path FramePath(const std::filesystem::path& folder, size_t frame) {
  char name[32];
  std::snprintf(name, sizeof(name), "frame_%04zu.png", frame);
  return folder / name;
}

void Run(const std::string& model_file, const std::filesystem::path& out,
         const LightOptions& light_options, const PictureOptions& options,
         lfm::Progress& progress) {
  CheckUsage(light_options, options, out);
  std::vector<Eigen::Vector3d> to_light;
  if (!light_options.light.empty()) to_light = lfm::ParseLightDirections(light_options.light);
  if (options.frames == 0 && to_light.size() > 1) {
    throw lfm::Error("--light has several directions, which are for a film; add --frames");
  }
  const lfm::RelightableModel model = lfm::ReadRelightable(model_file);
  if (model.width == 0) {
    throw lfm::Error(model_file + ": is a model of vertices, which have no picture of their own");
  }
  if (model.kind == lfm::FieldColumns::kViews) {
    throw lfm::Error(model_file + ": shows one light from many views; it cannot be relit");
  }
  const lfm::Relighter relighter(model);
  const Lights lights(model, light_options);
  lfm::Tone tone{options.exposure, options.tone};
  const std::vector<lfm::FrameLight> plan =
      lfm::PlanLights(light_options.rotate, to_light, std::max(options.frames, 1));
  if (options.frames > 0) progress.Start("relight", options.frames);
  for (size_t i = 0; i < plan.size(); ++i) {
    const lfm::Image linear =
        relighter.RelightPicture(relighter.Prepare(lights.Of(plan[i])), options.residuals);
    RequireFinitePicture(linear);
    if (i == 0 && options.auto_exposure) tone.exposure_stops += StopsToWhite(linear);
    const std::filesystem::path file = options.frames > 0 ? FramePath(out, i) : out;
    lfm::WriteImage(file.extension() == ".exr" ? linear : lfm::ShowLinear(tone, linear), file);
    if (options.frames > 0) progress.Advance();
  }
}

/// The rotation camera_from_world of a capture's reflectance field.
Eigen::Matrix3d CameraOf(const std::filesystem::path& capture_folder) {
  const lfm::Capture capture = lfm::LoadCapture(capture_folder);
  if (!capture.reflectance_field || !capture.reflectance_field->camera_from_world) {
    throw lfm::Error(capture_folder.string() +
                     ": has no reflectance field whose camera is known; leave --capture out");
  }
  return capture.reflectance_field->camera_from_world->rotation;
}

/// Pages replace pages, and nothing else: a file of one of their names in a folder without pages is
/// somebody's.
void RequireNothingOfOthers(const std::filesystem::path& model_file,
                            const std::filesystem::path& out) {
  if (out.empty()) throw lfm::Error("--web needs a folder to write to; name one");
  std::error_code absent;
  if (std::filesystem::exists(out / "relight.html", absent)) return;
  for (const char* name : {"model.lfr", "index.html", "app.js"}) {
    const std::filesystem::path there = out / name;
    if (!std::filesystem::exists(there, absent)) continue;
    if (std::filesystem::equivalent(model_file, there, absent)) continue;
    throw lfm::Error(there.string() +
                     " is somebody else's, which --web would replace; name another folder");
  }
}

void WriteForBrowsers(const std::filesystem::path& model_file, const std::filesystem::path& out,
                      const PageOptions& options) {
  const std::string lfr = lfm::ReadFile(model_file);
  const lfm::RelightableModel model =
      lfm::DecodeRelightable(std::as_bytes(std::span(lfr)), model_file.string());
  if (model.width == 0) {
    throw lfm::Error(model_file.string() +
                     ": is a model of vertices, which have no picture of their own");
  }
  if (model.kind == lfm::FieldColumns::kViews) {
    throw lfm::Error(model_file.string() + ": shows one light from many views");
  }
  // What the page could not light is an Error here.
  lfm::MakeLightCells(model.kind, model.directions, {});
  std::optional<Eigen::Matrix3d> camera;
  if (!options.capture.empty()) camera = CameraOf(options.capture);
  RequireNothingOfOthers(model_file, out);
  lfm::WriteRelightPages(lfr, model.name.empty() ? model_file.stem().string() : model.name, out,
                         camera);
}

/// What the pages leave to the hand has no effect on them.
void CheckPageUsage(const lfm::CommandLine& command) {
  for (const char* name :
       {"environment", "rotate", "light", "irradiance", "light-radius", "max-angle", "residuals",
        "frames", "exposure", "auto-exposure", "tone"}) {
    if (command.Given(name)) {
      throw lfm::Error(std::string("--") + name +
                       " has no effect with --web, whose pages are lit by hand; leave it out");
    }
  }
}

}  // namespace

int main(int argc, char** argv) {
  std::string model_file, out;
  LightOptions light;
  PictureOptions picture;
  PageOptions page;
  lfm::CommandLine command(
      "lfm-relight",
      "Shows a reflectance field under new light: surroundings, a light from a direction, or both; "
      "one picture, or a film in which they turn; or writes it for browsers (--web).",
      "lfm-relight plant.lfr plant.png --environment sky.hdr --rotate 30 --auto-exposure");
  command.Positional("MODEL", "The model, a .lfr file (docs/formats.md).", model_file);
  command.Positional("OUT",
                     "The picture to write: .png or .jpg as shown, .exr in linear light without "
                     "exposure and tone; a folder with --frames and --web.",
                     out);
  command.Options(lfm::AnyOptions(light), "Light");
  command.Options(lfm::AnyOptions(picture), "Picture");
  command.Options(lfm::AnyOptions(page), "Browsers");
  return command.Run(argc, argv, [&](lfm::Progress& progress) {
    if (page.web) {
      CheckPageUsage(command);
      return WriteForBrowsers(model_file, out, page);
    }
    if (command.Given("capture")) throw lfm::Error("--capture has no effect without --web");
    Run(model_file, out, light, picture, progress);
  });
}
