// SPDX-License-Identifier: BSD-3-Clause
// The whole way, from a small capture to a model, a picture and a report.
#include <gtest/gtest.h>

#include <algorithm>
#include <csignal>
#include <filesystem>
#include <map>
#include <set>
#include <tuple>

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
  std::set<std::string> shown;  // which stages' pictures
  const std::string source = "<img loading=lazy src=\"";
  for (size_t at = page.find(source); at != std::string::npos; at = page.find(source, at + 1)) {
    const size_t name_at = at + source.size();
    const std::string file = page.substr(name_at, page.find('"', name_at) - name_at);
    EXPECT_NO_THROW(ReadImage(small.work() / "report" / file)) << file;
    const std::string name = fs::path(file).filename();
    shown.insert(name.substr(0, name.find('-')));
  }
  EXPECT_EQ(shown, (std::set<std::string>{"calib", "scan", "mesh", "resample", "encode", "heldout",
                                          "model"}));
  EXPECT_NE(page.find("<iframe src=\"web/model.html\""), std::string::npos);
  EXPECT_EQ(ReadFile(small.work() / "report" / "web" / "model.glb"),
            ReadFile(small.work() / "encode" / "model.glb"));

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
  // About three times what a sound run of so small a capture reaches.
  const std::tuple<const char*, double, double> bounds[] = {
      {"pose_median_mm", 0, 0.1},
      {"pose_median_deg", 0, 0.01},
      {"pose_max_mm", 0, 0.3},
      {"pose_max_deg", 0, 0.05},
      {"pose_aligned_median_mm", 0, 0.1},
      {"pose_scale_percent", -0.1, 0.1},
      {"pose_chi2", 0.05, 30},
      {"focal_error_percent", 0, 0.3},
      {"principal_point_error_px", 0, 2},
      {"scanner_focal_error_percent", 0, 0.5},
      {"scanner_principal_point_error_px", 0, 3},
      {"points_median_mm", 0, 0.2},
      {"points_p95_mm", 0, 0.7},
      {"points_over_1_mm_share", -1, 0.01},
      {"points_completeness", 0.6, 1},
      {"seen_share", 0.6, 1},
      {"surface_mean_mm", 0, 0.6},
      {"surface_rms_mm", 0, 3},
      {"surface_p95_mm", 0, 2},
      {"surface_max_mm", 0, 30},
      {"surface_accuracy", 0.3, 1},
      {"surface_completeness", 0.3, 1},
      {"surface_f_score", 0.3, 1},
      {"mesh_mean_mm", 0, 0.9},
      {"mesh_p95_mm", 0, 2.6},
      {"heldout_psnr_noisefree_db", 20, 60}};
  for (const auto& [key, above, below] : bounds) {
    ASSERT_TRUE(with_truth["truth"].contains(key)) << key;
    EXPECT_GT(with_truth["truth"][key].get<double>(), above) << key;
    EXPECT_LT(with_truth["truth"][key].get<double>(), below) << key;
  }
  EXPECT_EQ(with_truth["truth"].size(), std::size(bounds));
  EXPECT_EQ(with_truth["evaluate"]["foreground"], "true mask");

  // Another model: what was found of the first one must not stand in its report.
  ASSERT_EQ(small.RunPipeline({"-q", "--terms", "1"}).status, 0);
  const json of_another = ReadJson(small.work() / "report" / "report.json");
  EXPECT_FALSE(of_another.contains("truth"));
  EXPECT_EQ(of_another["evaluate"]["foreground"], "silhouette of the dense surface");
}

TEST(Pipeline, InterruptedItGoesOnToTheSameBytes) {
  const SmallCapture whole, broken;
  whole.BeginAfter({"calib", "scan", "mesh", "resample", "encode"});
  int interrupted = 0;
  for (double after : {0.3, 1.0, 2.0, 4.0}) {
    CommandSettings settings;
    settings.signal_after_seconds = after;
    const CommandOutcome outcome = broken.RunPipeline({"-q", "--to", "encode"}, settings);
    if (outcome.status == 130) {
      ++interrupted;
      EXPECT_TRUE(IsOneLineWith(outcome.err, {"lfm-pipeline: interrupted", "to go on"}))
          << outcome.err;
    }
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

TEST(Pipeline, KilledItGoesOnToTheSameBytes) {
  const SmallCapture whole, broken;
  whole.BringGeometry();
  broken.BringGeometry();
  ASSERT_EQ(whole.RunPipeline({"-q", "--to", "encode"}).status, 0);
  int killed = 0;
  for (double after : {0.1, 0.4, 0.9, 1.6, 2.5}) {
    CommandSettings settings;
    settings.signal = SIGKILL;
    settings.signal_after_seconds = after;
    const CommandOutcome outcome = broken.RunPipeline({"-q", "--to", "encode"}, settings);
    EXPECT_TRUE(outcome.status == 128 + SIGKILL || outcome.status == 0) << outcome.err;
    if (outcome.status != 0) ++killed;
  }
  EXPECT_GT(killed, 0);
  ASSERT_EQ(broken.RunPipeline({"-q", "--to", "encode"}).status, 0);
  EXPECT_EQ(HashResults(broken.work()), HashResults(whole.work()));
  for (const auto& entry : fs::recursive_directory_iterator(broken.work())) {
    EXPECT_NE(entry.path().filename().string().front(), '.') << entry.path();
  }
}

TEST(Pipeline, ThreadsDoNotChangeTheResult) {
  const SmallCapture one, two;
  ASSERT_EQ(one.RunPipeline({"-q", "--to", "evaluate", "--threads", "1"}).status, 0);
  two.BeginAfter({"calib", "scan", "mesh", "resample", "encode", "evaluate"});
  EXPECT_EQ(HashResults(one.work()), HashResults(two.work()));
}

TEST(Pipeline, ACaptureThatBringsItsGeometryStartsAtResampling) {
  const SmallCapture small;
  small.BringGeometry();
  json manifest = small.Manifest();
  // Test photographs may be gray or have an alpha channel.
  std::vector<fs::path> tests;
  for (const json& photo : manifest["photos"]) {
    if (photo["split"] == "test") {
      tests.push_back(small.capture() / photo["file"].get<std::string>());
    }
  }
  ASSERT_GE(tests.size(), 3u);
  WriteImage(ToGray(ReadImage(tests[0])), tests[0]);
  const Image color = ReadImage(tests[1]);
  Image with_alpha(color.width(), color.height(), 4, PixelType::kUint8, ColorEncoding::kSrgb);
  for (int y = 0; y < color.height(); ++y) {
    for (int x = 0; x < color.width(); ++x) {
      std::copy_n(&color.At<uint8_t>(x, y), 3, &with_alpha.At<uint8_t>(x, y));
    }
  }
  WriteImage(with_alpha, tests[1]);

  const CommandOutcome outcome = small.RunPipeline({"-q"});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const json report = ReadJson(small.work() / "report" / "report.json");
  EXPECT_EQ(report["scan"]["points"], 0);
  EXPECT_EQ(report["evaluate"]["photos_scored"], tests.size());
  EXPECT_EQ(report["evaluate"]["photos_missing"], 0);
  for (size_t photo = 1; photo < tests.size(); ++photo) {
    EXPECT_GT(report["evaluate"]["photos"][photo]["full"]["psnr_db"].get<double>(), 18) << photo;
  }

  // The manifest says how files are read, so it counts for every stage that reads them.
  for (auto& [key, camera] : manifest["cameras"].items()) camera["encoding"] = "srgb";
  small.SetManifest(manifest);
  const CommandOutcome changed = small.RunPipeline({"--to", "resample", "--verbose"});
  ASSERT_EQ(changed.status, 0) << changed.err;
  EXPECT_NE(changed.err.find("mesh: unchanged"), std::string::npos) << changed.err;
  EXPECT_NE(changed.err.find("resample: runs: " + (small.capture() / "capture.json").string()),
            std::string::npos)
      << changed.err;

  // Without test photographs there is no score, but a report all the same.
  for (json& photo : manifest["photos"]) photo["split"] = "train";
  small.SetManifest(manifest);
  const CommandOutcome unscored = small.RunPipeline({"-q"});
  ASSERT_EQ(unscored.status, 0) << unscored.err;
  EXPECT_NE(unscored.out.find("no score"), std::string::npos) << unscored.out;
  const json without = ReadJson(small.work() / "report" / "report.json");
  EXPECT_EQ(without["evaluate"]["photos_scored"], 0);
  EXPECT_FALSE(without["evaluate"].contains("heldout_psnr_db"));
  EXPECT_TRUE(fs::exists(small.work() / "report" / "index.html"));
}

TEST(Pipeline, ScoresAnybodysPicturesByTheSameRule) {
  const SmallCapture small;
  small.BeginAfter({"calib", "scan", "mesh", "resample", "encode", "evaluate"});
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
