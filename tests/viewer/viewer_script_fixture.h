// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <numbers>
#include <string>
#include <vector>

#include "core/atomic_file.h"
#include "core/image_metrics.h"
#include "core/json_reader.h"
#include "encode/glb.h"
#include "synthetic_model.h"
#include "tests/support/run_command.h"
#include "tests/support/scratch_folder.h"
#include "viewer/reference_renderer.h"
#include "viewer/scene.h"
#include "viewer/view_options.h"

namespace lfm {

inline const std::string kLfmViewer = std::string(LFM_BIN_DIR) + "/lfm-viewer";
inline constexpr double kMinPsnrDb = 45;
inline constexpr double kDegree = std::numbers::pi / 180;

/// Plays scripts in lfm-viewer's hidden window, on a model or scene in a scratch folder.
class ViewerScriptCommand : public testing::Test {
 protected:
  void SetUp() override {
    WriteGlb(MakeSmoothRandomModel(1, DirectionMap::kHemiOctahedral), model_);
    view_.size = "240x200";
  }

  /// Plays the lines in the scratch folder; {} in them is that folder.
  CommandOutcome Play(const std::string& lines, std::vector<std::string> more = {}) {
    return PlayOn(model_, lines, std::move(more));
  }
  CommandOutcome PlayOn(const std::string& model, const std::string& lines,
                        std::vector<std::string> more = {}, const CommandSettings& settings = {}) {
    std::string script = lines;
    for (size_t at; (at = script.find("{}")) != std::string::npos;) {
      script.replace(at, 2, scratch_.folder.string());
    }
    WriteFileAtomically(scratch_.folder / "script.txt", script);
    std::filesystem::create_directories(here_);
    std::vector<std::string> arguments = {"env",      "-C",       here_.string(),
                                          "xvfb-run", "-a",       kLfmViewer,
                                          model,      "--script", scratch_.folder / "script.txt",
                                          "--size",   view_.size, "--multisample",
                                          "1"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return RunCommand(arguments, settings);
  }

  nlohmann::json State(const std::string& name) const { return ReadJson(scratch_.folder / name); }
  Image Picture(const std::string& name) const { return ReadImage(scratch_.folder / name); }

  /// The camera that a state file tells of.
  OrbitCamera CameraOf(const nlohmann::json& state) const {
    OrbitCamera camera = MakeOrbitCamera(MakeSmoothRandomModel(1, {}).mesh, view_);
    camera.azimuth = state.at("azimuth").get<double>() * kDegree;
    camera.elevation = state.at("elevation").get<double>() * kDegree;
    camera.distance = state.at("distance");
    for (int i = 0; i < 3; ++i) camera.target[i] = state.at("target")[i];
    return camera;
  }

  /// Against the reference renderer, over the object.
  double Psnr(const Image& picture, const Scene& scene, const OrbitCamera& orbit,
              RenderOptions options = {}) const {
    options.background = ParseColor(view_.background);
    const Rendering expected =
        ReferenceRenderer(scene).Render(PinholeCamera(orbit, picture.width(), picture.height()),
                                        CameraFromWorld(orbit), options, SilentProgress());
    return CompareImages(picture, expected.color, expected.coverage).psnr_db;
  }

  ScratchFolder scratch_;
  const std::filesystem::path here_ = scratch_.folder / "here";  ///< the current folder
  ViewOptions view_;
  const std::string model_ = scratch_.folder / "model.glb";
};

}  // namespace lfm
