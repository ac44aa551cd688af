// SPDX-License-Identifier: BSD-3-Clause
// The whole way, from a small capture to a model, a picture and a report.
#include <gtest/gtest.h>

#include <csignal>
#include <filesystem>
#include <map>

#include "core/atomic_file.h"
#include "core/hash.h"
#include "core/image.h"
#include "tests/end_to_end/small_capture.h"

namespace lfm {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

// Hashes of every result; records and reports hold times and are left out.
std::map<std::string, std::string> HashResults(const fs::path& work) {
  std::map<std::string, std::string> hashes;
  for (const auto& entry : fs::recursive_directory_iterator(work)) {
    const std::string name = fs::relative(entry.path(), work);
    if (!entry.is_regular_file() || name.ends_with("stage.json") || name.starts_with("report")) {
      continue;
    }
    hashes[name] = Hasher().AddFile(entry.path()).HexDigest();
  }
  return hashes;
}

TEST(Pipeline, MakesAModelAndAReportFromTheSmallCapture) {
  const SmallCapture small;
  const CommandOutcome outcome = small.RunPipeline();
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const json report = ReadJson(small.work() / "report" / "report.json");
  for (const char* place : {"/calib/photos_used",
                            "/calib/photos_rejected",
                            "/calib/reprojection_rms_px",
                            "/scan/points",
                            "/mesh/vertices",
                            "/mesh/triangles",
                            "/resample/mean_visible_views",
                            "/resample/samples_per_triangle",
                            "/resample/dense_bytes",
                            "/encode/terms_mean",
                            "/encode/terms_max",
                            "/encode/model_bytes",
                            "/encode/maps_bytes",
                            "/encode/compression_ratio",
                            "/encode/matrix_psnr_db",
                            "/evaluate/heldout_psnr_db",
                            "/evaluate/heldout_psnr_mean_only_db",
                            "/evaluate/heldout_ssim",
                            "/evaluate/heldout_ape",
                            "/time/calib_s",
                            "/time/scan_s",
                            "/time/mesh_s",
                            "/time/resample_s",
                            "/time/encode_s",
                            "/time/evaluate_s",
                            "/time/report_s",
                            "/time/total_s",
                            "/memory/peak_mib"}) {
    const json::json_pointer pointer(place);
    ASSERT_TRUE(report.contains(pointer)) << place;
    EXPECT_TRUE(report[pointer].is_number()) << place;
  }
  EXPECT_TRUE(report["mesh"]["closed_manifold"].get<bool>());
  // What so small a capture must reach: a broken stage falls far below.
  EXPECT_GT(report["evaluate"]["heldout_psnr_db"].get<double>(), 20);
  EXPECT_GT(report["evaluate"]["heldout_psnr_db"].get<double>(),
            report["evaluate"]["heldout_psnr_mean_only_db"].get<double>());
  EXPECT_LT(report["calib"]["reprojection_rms_px"].get<double>(), 0.5);

  const std::string page = ReadFile(small.work() / "report" / "index.html");
  for (size_t at = page.find("src=\""); at != std::string::npos; at = page.find("src=\"", at + 1)) {
    const std::string file = page.substr(at + 5, page.find('"', at + 5) - at - 5);
    EXPECT_NO_THROW(ReadImage(small.work() / "report" / file)) << file;
  }

  // A second run finds everything done.
  const CommandOutcome again = small.RunPipeline();
  EXPECT_EQ(again.status, 0);
  EXPECT_NE(again.err.find("encode: unchanged"), std::string::npos) << again.err;
  EXPECT_NE(again.err.find("report: unchanged"), std::string::npos) << again.err;

  // The truth lies beside the capture; only now is it opened.
  const CommandOutcome evaluated =
      RunCommand({SmallCapture::Command("lfm-evaluate"), small.capture().string(),
                  small.work().string(), "--ground-truth", "-q"});
  ASSERT_EQ(evaluated.status, 0) << evaluated.err;
  const json with_truth = ReadJson(small.work() / "report" / "report.json");
  for (const char* key : {"pose_median_mm", "pose_median_deg", "points_median_mm",
                          "points_completeness", "surface_mean_mm", "surface_p95_mm",
                          "mesh_mean_mm", "mesh_p95_mm", "heldout_psnr_noisefree_db"}) {
    EXPECT_TRUE(with_truth["truth"].contains(key)) << key;
  }
}

TEST(Pipeline, InterruptedItGoesOnToTheSameBytes) {
  const SmallCapture whole, broken;
  ASSERT_EQ(whole.RunPipeline({"-q", "--to", "encode"}).status, 0);
  int interrupted = 0;
  for (double after : {0.3, 1.0, 2.0, 4.0}) {
    CommandSettings settings;
    settings.interrupt_after_seconds = after;
    const CommandOutcome outcome = broken.RunPipeline({"-q", "--to", "encode"}, settings);
    if (outcome.status == 130) ++interrupted;
    EXPECT_TRUE(outcome.status == 130 || outcome.status == 0) << outcome.err;
    if (!fs::exists(broken.work())) continue;
    for (const auto& entry : fs::directory_iterator(broken.work())) {
      EXPECT_NE(entry.path().filename().string().front(), '.') << entry.path();
    }
  }
  EXPECT_GT(interrupted, 0);
  ASSERT_EQ(broken.RunPipeline({"-q", "--to", "encode"}).status, 0);
  EXPECT_EQ(HashResults(broken.work()), HashResults(whole.work()));
}

TEST(Pipeline, ThreadsDoNotChangeTheResult) {
  const SmallCapture one, two;
  ASSERT_EQ(one.RunPipeline({"-q", "--to", "evaluate", "--threads", "1"}).status, 0);
  ASSERT_EQ(two.RunPipeline({"-q", "--to", "evaluate", "--threads", "2"}).status, 0);
  EXPECT_EQ(HashResults(one.work()), HashResults(two.work()));
}

TEST(Pipeline, ACaptureThatBringsItsGeometryStartsAtResampling) {
  const SmallCapture small;
  // The truth of the capture, with the photographs' own files: poses, intrinsics and a mesh.
  json manifest = ReadJson(small.capture() / "ground_truth" / "capture.json");
  const json original = small.Manifest();
  for (size_t i = 0; i < manifest["photos"].size(); ++i) {
    manifest["photos"][i]["file"] = original["photos"][i]["file"];
    manifest["photos"][i]["split"] = original["photos"][i]["split"];
    manifest["photos"][i].erase("mask");
  }
  manifest["mesh"] = "ground_truth/" + manifest["mesh"].get<std::string>();
  manifest.erase("scanner");
  manifest.erase("board");
  small.SetManifest(manifest);
  const CommandOutcome outcome = small.RunPipeline({"-q"});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const json report = ReadJson(small.work() / "report" / "report.json");
  EXPECT_EQ(report["scan"]["points"], 0);
  EXPECT_GT(report["evaluate"]["heldout_psnr_db"].get<double>(), 20);
}

TEST(Pipeline, ScoresAnybodysPicturesByTheSameRule) {
  const SmallCapture small;
  ASSERT_EQ(small.RunPipeline({"-q", "--to", "evaluate"}).status, 0);
  // The photographs themselves must score as a perfect picture.
  const fs::path images = small.work() / "images";
  const json manifest = small.Manifest();
  for (const json& photo : manifest["photos"]) {
    if (photo["split"] != "test") continue;
    WriteImage(ToSrgb8(ReadImage(small.capture() / photo["file"].get<std::string>())),
               images / (photo["id"].get<std::string>() + ".png"));
  }
  const auto evaluate = [&] {
    return RunCommand({SmallCapture::Command("lfm-evaluate"), small.capture().string(),
                       small.work().string(), "--images", images.string(), "-q"});
  };
  const CommandOutcome outcome = evaluate();
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_NE(outcome.out.find("images.heldout_psnr_db 99.0000"), std::string::npos) << outcome.out;
  fs::remove(fs::directory_iterator(images)->path());
  EXPECT_EQ(evaluate().status, 2);
}

TEST(Pipeline, StagesCanBeNamed) {
  const SmallCapture small;
  EXPECT_EQ(small.RunPipeline({"--from", "mesh", "-q"}).status, 2);  // nothing before it has run
  EXPECT_EQ(small.RunPipeline({"--from", "nonsense", "-q"}).status, 2);
  EXPECT_EQ(small.RunPipeline({"--from", "mesh", "--to", "calib", "-q"}).status, 2);
}

}  // namespace
}  // namespace lfm
