// SPDX-License-Identifier: BSD-3-Clause
#include "pipeline/light_evaluation.h"

#include <algorithm>
#include <cstdio>
#include <numbers>

#include "core/error.h"
#include "fields/heldout_lights.h"
#include "fields/light_methods.h"
#include "fields/model_methods.h"
#include "fields/relightable_file.h"
#include "pipeline/light_pipeline.h"
#include "pipeline/picture_sheet.h"
#include "pipeline/stage_cache.h"

namespace lfm {
namespace fs = std::filesystem;
namespace {

using nlohmann::json;

constexpr int kAllResiduals = -1;

int MostResiduals(const ClusteredModel& model) {
  int64_t most = 0;
  for (int64_t row = 0; row < model.rows && !model.first_residual.empty(); ++row) {
    most = std::max(most, model.first_residual[row + 1] - model.first_residual[row]);
  }
  return static_cast<int>(most);
}

// Rising, all of them last.
std::vector<int> ResidualCounts(const ClusteredModel& model) {
  const int most = MostResiduals(model);
  std::vector<int> counts;
  for (int count : {0, 4, 12, 32, 64}) {
    if (count < most) counts.push_back(count);
  }
  counts.push_back(kAllResiduals);
  return counts;
}

void RequireSameField(const Field& train, const RelightableModel& relightable) {
  const auto same = [](const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
    return (a - b).norm() < 1e-5;
  };
  if (relightable.points != train.points || relightable.channels != train.channels ||
      relightable.directions.size() != train.directions.size() ||
      !std::equal(train.directions.begin(), train.directions.end(), relightable.directions.begin(),
                  same)) {
    throw Error(train.name +
                ": the model is not one of this capture's training lights as they are read now; "
                "run lfm-pipeline again");
  }
}

std::string DirectionText(const Eigen::Vector3d& to_light) {
  constexpr double kDegrees = 180 / std::numbers::pi;
  char text[80];
  std::snprintf(text, sizeof text, "%.0f degrees above the horizon, azimuth %.0f degrees",
                std::asin(std::clamp(to_light.z(), -1.0, 1.0)) * kDegrees,
                std::atan2(to_light.y(), to_light.x()) * kDegrees);
  return text;
}

// The methods that people want to see beside each other, by their names.
std::vector<size_t> ShownMethods(const std::vector<LightMethod>& methods, size_t model) {
  std::vector<size_t> shown = {model};
  for (const char* name : {"interpolated pictures", "HSH 16", "PTM"}) {
    for (size_t i = 0; i < methods.size(); ++i) {
      if (methods[i].name == name) shown.push_back(i);
    }
  }
  return shown;
}

json DrawLights(const ReflectanceFieldData& data, const Image& mask, double white,
                const std::vector<LightMethod>& methods, size_t model, const fs::path& folder) {
  constexpr int kLights = 4, kGain = 4, kMargin = 6;
  const Field& held_out = data.held_out;
  const int count = std::min(kLights, held_out.functions.columns);
  json pictures = json::array();
  for (int i = 0; i < count; ++i) {
    const int light = i * held_out.functions.columns / count;
    const Eigen::Vector3d& to_light = held_out.directions[light];
    const Image truth = PictureOfColumn(held_out, light, white);
    std::vector<Image> row = {CropToMask(truth, mask, kMargin)}, differences;
    std::string names;
    for (size_t method : ShownMethods(methods, model)) {
      const Image shown = PictureOfRows(held_out, methods[method].predict(to_light), white);
      row.push_back(CropToMask(shown, mask, kMargin));
      differences.push_back(
          CropToMask(DifferencePicture(shown, truth, mask, kGain), mask, kMargin));
      names += ", " + methods[method].name;
    }
    const std::string name = "light-" + std::to_string(i);
    WriteImage(SideBySide(row), folder / (name + ".png"));
    WriteImage(SideBySide(differences), folder / (name + "-differences.png"));
    pictures.push_back({{"file", name + ".png"},
                        {"caption", "Held-out light " + data.held_out_files[light] + " (" +
                                        DirectionText(to_light) + "): the picture" + names + "."}});
    pictures.push_back({{"file", name + "-differences.png"},
                        {"caption", "Their differences from the picture, enlarged " +
                                        std::to_string(kGain) + " times."}});
  }
  return pictures;
}

}  // namespace

json EvaluateLights(const ReflectanceFieldData& data, const RelightableModel& relightable,
                    const fs::path& pictures, Progress& progress) {
  RequireSameField(data.train, relightable);
  const double white = DisplayWhite(data.train);
  const Image mask = ObjectMask(data.train, white);
  progress.Start("evaluate: classic fits", 1);
  const ClassicFits classics = FitClassics(data.train, DomeFrame(data.train.directions));
  progress.Advance();
  const std::vector<int> counts = ResidualCounts(relightable.model);
  std::vector<LightMethod> methods = ModelMethods(relightable, "model", counts);
  const size_t model = methods.size() - 1;  // with all residuals
  methods.push_back(InterpolatedPictures(data.train));
  methods.push_back(NearestPicture(data.train));
  for (LightMethod& method : ClassicMethods(classics, data.train)) {
    methods.push_back(std::move(method));
  }
  const LightScores scores = ScoreLightMethods(data.held_out, mask, white, methods, progress);
  json figures = LightScoresToJson(scores);
  figures["foreground"] =
      data.train.mask.empty() ? "pixels that some training light brightens" : "the capture's mask";
  json heights = json::array();
  for (const Eigen::Vector3d& to_light : data.held_out.directions) {
    if (scores.lights > 0) heights.push_back(std::asin(std::clamp(to_light.z(), -1.0, 1.0)));
  }
  figures["light_heights"] = heights;
  if (scores.lights == 0) {
    figures["note"] = "no light was held out, so nothing was scored";
    return figures;
  }
  figures["heldout_psnr_db"] = scores.methods[model].psnr_db;
  figures["heldout_ssim"] = scores.methods[model].ssim;
  figures["heldout_ape"] = scores.methods[model].ape;
  figures["heldout_relative_error"] = scores.methods[model].relative_error;
  if (!pictures.empty()) {
    figures["pictures"] = DrawLights(data, mask, white, methods, model, pictures);
  }
  return figures;
}

json EvaluateLightWorkspace(const fs::path& capture, const Workspace& workspace,
                            const fs::path& model, Progress& progress) {
  LightPipelineOptions options;
  OptionsFromJson(AnyOptions(options), ReadStageRecord(workspace.folder, "encode").options,
                  (workspace.Stage("encode") / "stage.json").string());
  const ReflectanceFieldData data = ReadReflectanceField(
      OpenFieldCapture(capture, options.capture, progress), options.read, progress);
  const fs::path file = model.empty() ? workspace.RelightableFile() : model;
  return EvaluateLights(data, ReadRelightable(file), {}, progress);
}

}  // namespace lfm
