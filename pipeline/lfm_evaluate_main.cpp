// SPDX-License-Identifier: BSD-3-Clause
#include <cstdio>
#include <string>

#include "core/command_line.h"
#include "core/error.h"
#include "fields/heldout_lights.h"
#include "pipeline/evaluation.h"
#include "pipeline/light_evaluation.h"
#include "pipeline/light_pipeline.h"
#include "pipeline/pipeline.h"
#include "pipeline/truth_record.h"

namespace {

struct EvaluateOptions {
  bool ground_truth = false, geometry = false;
  std::string images, model;
  void Declare(lfm::OptionVisitor& v) {
    v.Flag({"ground-truth", "Compare with CAPTURE/ground_truth too (synthetic captures)."},
           ground_truth);
    v.Flag({"geometry",
            "Compare only cameras, points and surfaces with CAPTURE/ground_truth, as far as the "
            "stages have run."},
           geometry);
    v.Text({"model",
            "Score this model, a .glb, .lfz or .wrl file, instead of WORK/encode/model.glb; of "
            "captures "
            "that vary in light a .lfr file instead of WORK/encode/model.lfr."},
           model);
    v.Text({"images",
            "Score this folder's pictures ID.png of the test photographs' cameras "
            "instead of the model."},
           images);
  }
};

void PrintFigures(const char* group, const nlohmann::json& figures) {
  for (const auto& [key, value] : figures.items()) {
    if (value.is_number()) std::printf("%s.%s %.4f\n", group, key.c_str(), value.get<double>());
    if (value.is_string()) {
      std::printf("%s.%s %s\n", group, key.c_str(), value.get<std::string>().c_str());
    }
  }
}

void EvaluateLights(const std::string& capture, const lfm::Workspace& workspace,
                    const EvaluateOptions& options, lfm::Progress& progress) {
  if (options.geometry || options.ground_truth || !options.images.empty()) {
    throw lfm::Error(
        "--geometry, --ground-truth and --images are for captures of photographs; the pictures of "
        "held-out lights are the truth of this one");
  }
  const nlohmann::json figures =
      lfm::EvaluateLightWorkspace(capture, workspace, options.model, progress);
  std::fputs(lfm::LightFiguresToTable(figures).c_str(), stdout);
  PrintFigures("evaluate", figures);
}

}  // namespace

int main(int argc, char** argv) {
  std::string capture_folder, work;
  EvaluateOptions options;
  lfm::CommandLine line(
      "lfm-evaluate",
      "Says how good a model is on photographs that it never saw: renders the "
      "test photographs' cameras and compares foreground pixels. Of a capture that varies in "
      "light: how good it is on lights that it never saw.",
      "lfm-evaluate demo/capture demo/work --ground-truth");
  line.Positional("CAPTURE", "Capture folder, .lp file or DiLiGenT folder.", capture_folder);
  line.Positional("WORK", "Workspace folder that lfm-pipeline filled.", work);
  line.Options(lfm::AnyOptions(options));
  return line.Run(argc, argv, [&](lfm::Progress& progress) {
    const lfm::Workspace workspace{work};
    if (lfm::VariesInLight(capture_folder)) {
      EvaluateLights(capture_folder, workspace, options, progress);
      return;
    }
    const lfm::Capture capture = lfm::LoadCapture(capture_folder);
    if (options.geometry && (options.ground_truth || !options.images.empty())) {
      throw lfm::Error("--geometry compares geometry alone; leave out --ground-truth and --images");
    }
    if (!options.model.empty() &&
        (options.geometry || options.ground_truth || !options.images.empty())) {
      throw lfm::Error("--model scores a model alone; leave out the other choices");
    }
    if (options.geometry) {
      PrintFigures("truth", lfm::EvaluateGeometry(capture, workspace, progress));
      return;
    }
    if (!options.images.empty()) {
      PrintFigures("images",
                   lfm::EvaluateImages(capture, workspace, options.images,
                                       options.ground_truth ? lfm::Foreground::kTrueMask
                                                            : lfm::Foreground::kSurfaceSilhouette,
                                       progress));
      return;
    }
    if (!options.ground_truth) {
      PrintFigures("evaluate", lfm::EvaluateWorkspace(capture, workspace, progress, options.model));
      return;
    }
    const nlohmann::json inputs = lfm::TruthInputs(capture, workspace);
    const nlohmann::json result = lfm::EvaluateWithTruth(capture, workspace, progress);
    lfm::SaveTruth(workspace, inputs, result);
    PrintFigures("evaluate", result.at("evaluate"));
    PrintFigures("truth", result.at("truth"));
    lfm::RefreshReport(capture, workspace, progress);
  });
}
