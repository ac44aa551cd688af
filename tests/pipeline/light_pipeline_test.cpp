// SPDX-License-Identifier: BSD-3-Clause
#include "pipeline/light_pipeline.h"

#include <gtest/gtest.h>

#include <filesystem>

#include "core/atomic_file.h"
#include "core/error.h"
#include "core/json_reader.h"
#include "core/parallel.h"
#include "fields/ptm_file.h"
#include "fields/relightable_file.h"
#include "fields/rti_file.h"
#include "pipeline/light_evaluation.h"
#include "pipeline/pipeline.h"
#include "tests/pipeline/small_light_capture.h"
#include "tests/support/scratch_folder.h"

namespace lfm {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

class LightPipeline : public ::testing::Test {
 protected:
  LightPipeline() {
    options_.out = Work().string();
    options_.light.encode.sparse.clusters = 4;
    options_.light.encode.sparse.terms = 2;
    options_.light.encode.sparse.residual_threshold = 1e-3;
  }
  fs::path Capture() const { return scratch_.folder / "capture"; }
  fs::path Work() const { return scratch_.folder / "work"; }
  PipelineSummary Run() { return RunPipeline(Capture(), options_, SilentProgress()); }
  json Report() const { return ReadJson(Work() / "report" / "report.json"); }

  ScratchFolder scratch_;
  PipelineOptions options_;
};

double PsnrOf(const json& evaluate, const std::string& name) {
  for (const json& method : evaluate["methods"]) {
    if (method["name"] == name) return method["psnr_db"].get<double>();
  }
  ADD_FAILURE() << name;
  return 0;
}

TEST_F(LightPipeline, GoesFromPicturesToAReport) {
  WriteSmallLightCapture(Capture(), 48, HeldOutLights::kEveryFourth);
  EXPECT_TRUE(VariesInLight(Capture()));
  const PipelineSummary summary = Run();
  ASSERT_EQ(summary.stages.size(), 3u);
  EXPECT_EQ(summary.stages[0].first, "encode");
  const RelightableModel model = ReadRelightable(Work() / "encode" / "model.lfr");
  EXPECT_EQ(model.directions.size(), 36u);
  EXPECT_EQ(model.points, 12 * 9);
  const json report = Report();
  EXPECT_EQ(report["encode"], ReadJson(Work() / "encode" / "encode.json"));
  EXPECT_EQ(report["evaluate"], ReadJson(Work() / "evaluate" / "evaluation.json"));
  EXPECT_EQ(report["evaluate"]["lights"], 12);
  EXPECT_EQ(report["evaluate"]["pixels"], 11 * 9);
  EXPECT_EQ(report["encode"]["model_bytes"], fs::file_size(Work() / "encode" / "model.lfr"));
  // All residuals are the pictures but for the threshold, so both interpolate alike.
  EXPECT_NEAR(report["evaluate"]["heldout_psnr_db"].get<double>(),
              PsnrOf(report["evaluate"], "interpolated pictures"), 0.3);
  EXPECT_GT(PsnrOf(report["evaluate"], "interpolated pictures"),
            PsnrOf(report["evaluate"], "nearest light"));
  EXPECT_GT(PsnrOf(report["evaluate"], "HSH 16"), 20);
  const std::string page = ReadFile(Work() / "report" / "index.html");
  EXPECT_NE(page.find("HSH 16"), std::string::npos);
  EXPECT_NE(page.find("<svg"), std::string::npos);
  for (const json& picture : report["evaluate"]["pictures"]) {
    const std::string file = "pictures/" + picture["file"].get<std::string>();
    EXPECT_NE(page.find(file), std::string::npos);
    EXPECT_NO_THROW(ReadImage(Work() / "report" / file));
  }
  // lfm-evaluate's figures are the same.
  const json again = EvaluateLightWorkspace(Capture(), {Work()}, {}, SilentProgress());
  EXPECT_EQ(again["heldout_psnr_db"], report["evaluate"]["heldout_psnr_db"]);
}

TEST_F(LightPipeline, DoesAgainWhatHasChangedAlone) {
  WriteSmallLightCapture(Capture(), 20, HeldOutLights::kEveryFourth);
  Run();
  for (const auto& [stage, record] : Run().stages) EXPECT_TRUE(record.skipped) << stage;
  options_.light.encode.sparse.terms = 1;
  for (const auto& [stage, record] : Run().stages) EXPECT_FALSE(record.skipped) << stage;
  fs::copy_file(Capture() / "light_0.png", Capture() / "light_1.png",
                fs::copy_options::overwrite_existing);
  EXPECT_FALSE(Run().stages[0].second.skipped);
  options_.from = options_.to = "evaluate";
  EXPECT_EQ(Run().stages.size(), 1u);
}

TEST_F(LightPipeline, ThreadsDoNotChangeTheResult) {
  WriteSmallLightCapture(Capture(), 20, HeldOutLights::kEveryFourth);
  std::vector<std::string> models, scores;
  for (int threads : {1, 2}) {
    SetThreadCount(threads);
    options_.out = (scratch_.folder / ("work" + std::to_string(threads))).string();
    Run();
    models.push_back(ReadFile(fs::path(options_.out) / "encode" / "model.lfr"));
    scores.push_back(ReadFile(fs::path(options_.out) / "evaluate" / "evaluation.json"));
  }
  SetThreadCount(0);
  EXPECT_EQ(models[0], models[1]);
  EXPECT_EQ(scores[0], scores[1]);
}

TEST_F(LightPipeline, ReportLeavesOutWhatWasChangedSince) {
  WriteSmallLightCapture(Capture(), 12, HeldOutLights::kEveryFourth);
  Run();
  WriteFileAtomically(Work() / "encode" / "model.lfr", "another");
  options_.from = options_.to = "report";
  EXPECT_FALSE(Run().stages[0].second.skipped);
  EXPECT_TRUE(Report()["encode"].contains("out_of_date"));
  EXPECT_FALSE(Report()["evaluate"].contains("out_of_date"));
  EXPECT_FALSE(std::filesystem::exists(Work() / "report" / "web"));
}

TEST_F(LightPipeline, ReportHoldsThePagesThatRelight) {
  WriteSmallLightCapture(Capture(), 20, HeldOutLights::kEveryFourth);
  Run();
  const std::filesystem::path web = Work() / "report" / "web";
  const RelightableModel shown = ReadRelightable(web / "model.lfr");
  const RelightableModel whole = ReadRelightable(Work() / "encode" / "model.lfr");
  EXPECT_EQ(shown.points, whole.points);
  EXPECT_LE(shown.model.residual_value.size(), static_cast<size_t>(16 * shown.model.rows));
  EXPECT_NE(ReadFile(web / "relight.html").find("Content-Security-Policy"), std::string::npos);
  EXPECT_NE(ReadFile(Work() / "report" / "index.html").find("web/relight.html"), std::string::npos);
}

TEST_F(LightPipeline, ClusteredPcaIsTheOtherMethod) {
  WriteSmallLightCapture(Capture(), 20, HeldOutLights::kEveryFourth);
  options_.light.encode.method = FieldMethod::kPca;
  Run();
  EXPECT_EQ(Report()["encode"]["method"], "cpca");
  EXPECT_GT(Report()["evaluate"]["heldout_psnr_db"].get<double>(), 15);
}

TEST_F(LightPipeline, WritesFilesForRtiViewers) {
  WriteSmallLightCapture(Capture(), 20, HeldOutLights::kEveryFourth);
  options_.light.rti_files = true;
  options_.to = "encode";
  Run();
  EXPECT_EQ(ReadPtm(Work() / "encode" / "fits.ptm").fit.channels, 3);
  EXPECT_EQ(ReadPtm(Work() / "encode" / "fits_lrgb.ptm").fit.channels, 1);
  EXPECT_EQ(ReadRti(Work() / "encode" / "fits_9.rti").width, 12);
}

TEST_F(LightPipeline, TakesLpFiles) {
  WriteSmallLpCapture(Capture(), 24);
  EXPECT_TRUE(VariesInLight(Capture()));
  EXPECT_TRUE(VariesInLight(Capture() / "dome.lp"));
  options_.light.capture.held_out_lights = 6;
  const PipelineSummary summary = RunPipeline(Capture() / "dome.lp", options_, SilentProgress());
  EXPECT_EQ(summary.stages[1].second.figures["lights"], 4);
}

TEST_F(LightPipeline, WithoutHeldOutLightsThereIsNoScore) {
  WriteSmallLightCapture(Capture(), 5, HeldOutLights::kNone);
  Run();
  const json report = Report();
  EXPECT_TRUE(report["evaluate"].contains("note"));
  EXPECT_FALSE(report["evaluate"].contains("heldout_psnr_db"));
  EXPECT_TRUE(fs::exists(Work() / "report" / "index.html"));
}

TEST_F(LightPipeline, OneLightIsEnough) {
  WriteSmallLightCapture(Capture(), 1, HeldOutLights::kNone);
  Run();
  EXPECT_EQ(ReadRelightable(Work() / "encode" / "model.lfr").directions.size(), 1u);
}

TEST_F(LightPipeline, SaysWhatIsWrong) {
  EXPECT_FALSE(VariesInLight(Capture()));
  EXPECT_THROW(Run(), Error);  // there is no capture
  WriteSmallLightCapture(Capture(), 8, HeldOutLights::kEveryFourth);
  options_.to = "mesh";
  EXPECT_THROW(Run(), Error);
  options_.to = "report";
  options_.from = "evaluate";
  EXPECT_THROW(Run(), Error);  // encode has not run
  EXPECT_FALSE(fs::exists(Work()));
  options_.from = "calib";
  fs::remove(Capture() / "light_0.png");
  try {
    Run();
    FAIL();
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("light_0.png"), std::string::npos) << error.what();
  }
}

TEST_F(LightPipeline, AnotherCapturesModelIsRefused) {
  WriteSmallLightCapture(Capture(), 8, HeldOutLights::kEveryFourth);
  Run();
  const fs::path other = scratch_.folder / "other";
  WriteSmallLightCapture(other, 12, HeldOutLights::kEveryFourth);
  EXPECT_THROW(EvaluateLightWorkspace(other, {Work()}, {}, SilentProgress()), Error);
}

}  // namespace
}  // namespace lfm
