// SPDX-License-Identifier: BSD-3-Clause
#include "resample/resample.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "core/atomic_file.h"
#include "core/error.h"
#include "core/parallel.h"
#include "resample/patch_sampling.h"
#include "test_scenes.h"

namespace lfm {
namespace {

constexpr double kRadius = 40;

Eigen::Vector3d SmoothColor(const Eigen::Vector3d& p) {
  return {0.45 + p.x() / 120, 0.45 + p.y() / 120, 0.4 + p.z() / 150};
}

test::MemoryCapture SphereCapture(const test::ColorOf& color, const Eigen::Vector3d& background,
                                  int photos = 12, int samples = 2) {
  return test::MakeCapture(test::Sphere({0, 0, 0}, kRadius, 5), test::TestCamera(240, 180, 420),
                           test::PosesAround(photos, 260), color, background, samples);
}

ResampleOptions SmallOptions() {
  ResampleOptions options;
  options.view_grid = 8;
  return options;
}

/// Only triangles wholly in sight, and half of their samples data.
ResampleOptions WholeTriangles() {
  ResampleOptions options = SmallOptions();
  options.max_hidden_share = 0;
  options.min_data_share = 0.5;
  return options;
}

ResampleResult ResampleSphere(const test::MemoryCapture& made, const ResampleOptions& options,
                              const std::filesystem::path& file) {
  return Resample(made.capture, made.calib, test::Sphere({0, 0, 0}, kRadius, 5),
                  test::Sphere({0, 0, 0}, kRadius, 2), made.Loader(), options, file,
                  SilentProgress());
}

TEST(Resample, ReadsTheColoursOfASphere) {
  const auto made = SphereCapture(SmoothColor, {0, 0, 0});
  const auto file = test::TestFolder("sphere") / "resample" / "light_field.lfs";
  ResampleOptions options = SmallOptions();
  options.min_data_share = 1;
  const ResampleResult result = ResampleSphere(made, options, file);
  const LightField field = LightField::Open(file);
  ASSERT_EQ(field.triangle_count(), 320);
  EXPECT_EQ(result.near_edge_share, 0);
  EXPECT_EQ(field.photo_ids().size(), 12u);
  double views = 0, samples = 0;
  for (int t = 0; t < 320; ++t) {
    views += static_cast<double>(field.Patch(t).photos.size()) / 320;
    samples += PatchSampleCount(field.Patch(t).edge_samples) / 320.0;
  }
  EXPECT_NEAR(result.mean_visible_views, views, 1e-12 * views);
  EXPECT_NEAR(result.samples_per_triangle, samples, 1e-12 * samples);
  EXPECT_EQ(result.dense_bytes, field.DenseBytes());
  EXPECT_GT(result.mean_visible_views, 2);
  EXPECT_GT(result.unseen_triangles, 20);  // nobody looks from below
  EXPECT_LT(result.unseen_triangles, 160);
  EXPECT_EQ(result.saturated_share, 0);
  EXPECT_GT(result.seen_directions_share, 0.02);
  EXPECT_LT(result.seen_directions_share, 1);

  const RayScene surface(test::Sphere({0, 0, 0}, kRadius, 5));
  int64_t values = 0;
  for (int t = 0; t < field.triangle_count(); ++t) {
    const TrianglePatch patch = field.Patch(t);
    const auto points =
        PatchPoints(field.mesh(), t, patch.edge_samples, SampleOn::kMesh, surface, 0);
    for (size_t s = 0; s < points.size(); ++s) {
      for (size_t c = 0; c < 3; ++c) {
        for (size_t v = 0; v < patch.photos.size(); ++v) {
          const double value =
              double(patch.values[(s * 3 + c) * patch.photos.size() + v]) / LightField::kOne;
          // The facets lie up to 0.8 mm inside the sphere: parallax moves colour a little.
          EXPECT_NEAR(value, SmoothColor(points[s])[static_cast<int>(c)], 0.03);
          ++values;
        }
      }
    }
  }
  EXPECT_GT(values, 10000);
}

TEST(Resample, EstimatesWhatLiesNearEdges) {
  const auto made = SphereCapture(SmoothColor, {0, 0, 0});
  const auto file = test::TestFolder("near_edges") / "light_field.lfs";
  ResampleOptions options = SmallOptions();
  options.min_data_share = 1;
  const ResampleResult complete = ResampleSphere(made, options, file);
  options.min_data_share = 0.5;
  const ResampleResult half = ResampleSphere(made, options, file);
  EXPECT_GT(half.mean_visible_views, complete.mean_visible_views + 0.1);
  EXPECT_LT(half.unseen_triangles, complete.unseen_triangles);
  EXPECT_GT(half.near_edge_share, 0.001);
  EXPECT_LT(half.near_edge_share, 0.2);

  const LightField field = LightField::Open(file);
  const RayScene surface(test::Sphere({0, 0, 0}, kRadius, 5));
  double squares = 0;
  int64_t values = 0;
  for (int t = 0; t < field.triangle_count(); ++t) {
    const TrianglePatch patch = field.Patch(t);
    const auto points =
        PatchPoints(field.mesh(), t, patch.edge_samples, SampleOn::kMesh, surface, 0);
    for (size_t i = 0; i < patch.values.size(); ++i) {
      const size_t row = i / patch.photos.size();
      const double truth = SmoothColor(points[row / 3])[static_cast<int>(row % 3)];
      const double error = double(patch.values[i]) / LightField::kOne - truth;
      // Where no photograph has data the nearest sample stands in: half a triangle's gradient.
      EXPECT_LT(std::abs(error), 0.08);
      squares += error * error;
      ++values;
    }
  }
  EXPECT_LT(std::sqrt(squares / static_cast<double>(values)), 0.01);
}

TEST(Resample, LetsNoBackgroundBleedIn) {
  // Green object before magenta, edges mixed as a camera mixes them.
  const auto made = SphereCapture([](const Eigen::Vector3d&) { return Eigen::Vector3d(0, 0.8, 0); },
                                  {1, 0, 1}, 12, 3);
  for (const SampleOn sample_on : {SampleOn::kMesh, SampleOn::kSurface}) {
    ResampleOptions options = SmallOptions();
    options.max_grazing_deg = 89;
    options.sample_on = sample_on;
    const auto file = test::TestFolder("bleeding") / "light_field.lfs";
    const ResampleResult result = ResampleSphere(made, options, file);
    EXPECT_GT(result.mean_visible_views, 2);
    EXPECT_GT(result.near_edge_share, 0.001);
    const LightField field = LightField::Open(file);
    for (int t = 0; t < field.triangle_count(); ++t) {
      const TrianglePatch patch = field.Patch(t);
      for (size_t i = 0; i < patch.values.size(); ++i) {
        const size_t channel = i / patch.photos.size() % 3;
        const double value = double(patch.values[i]) / LightField::kOne;
        // What is estimated near edges is drawn to zero a little; no magenta may be in it.
        ASSERT_NEAR(value, channel == 1 ? 0.8 : 0, channel == 1 ? 0.01 : 0.001) << "triangle " << t;
      }
    }
  }
}

TEST(Resample, WouldBleedWithoutMargin) {
  // The scene of the test before is able to fail.
  const auto made = SphereCapture([](const Eigen::Vector3d&) { return Eigen::Vector3d(0, 0.8, 0); },
                                  {1, 0, 1}, 12, 3);
  ResampleOptions options = SmallOptions();
  options.max_grazing_deg = 89;
  options.depth_margin_px = 0;
  const auto file = test::TestFolder("no_margin") / "light_field.lfs";
  ResampleSphere(made, options, file);
  const LightField field = LightField::Open(file);
  int magenta = 0;
  for (int t = 0; t < field.triangle_count(); ++t) {
    const TrianglePatch patch = field.Patch(t);
    for (size_t i = 0; i < patch.values.size(); ++i) {
      if (i / patch.photos.size() % 3 == 0 && patch.values[i] > 300) ++magenta;
    }
  }
  EXPECT_GT(magenta, 0);
}

TEST(Resample, DoesNotDependOnTheNumberOfThreads) {
  // Bright enough that some samples saturate and are imputed.
  const auto made = SphereCapture(
      [](const Eigen::Vector3d& p) -> Eigen::Vector3d { return 1.4 * SmoothColor(p); }, {0, 0, 0},
      24, 1);
  std::vector<std::string> bytes;
  for (const int threads : {1, 2, 5}) {
    SetThreadCount(threads);
    const auto file = test::TestFolder("threads") / "light_field.lfs";
    const ResampleResult result = ResampleSphere(made, SmallOptions(), file);
    EXPECT_GT(result.saturated_share, 0.001);
    bytes.push_back(ReadFile(file));
  }
  SetThreadCount(0);
  EXPECT_TRUE(bytes[0] == bytes[1]);
  EXPECT_TRUE(bytes[0] == bytes[2]);
}

TEST(Resample, UsesTrainPhotographsWithAPoseOnly) {
  auto made = SphereCapture(SmoothColor, {0, 0, 0}, 6, 1);
  made.capture.photos[1].split = PhotoSplit::kTest;
  made.pictures.erase("photo1.png");                       // never opened
  made.calib.photos.erase(made.calib.photos.begin() + 3);  // set aside by the calibration
  made.pictures.erase("photo3.png");
  const auto file = test::TestFolder("splits") / "light_field.lfs";
  ResampleSphere(made, SmallOptions(), file);
  EXPECT_EQ(LightField::Open(file).photo_ids(),
            (std::vector<std::string>{"photo0", "photo2", "photo4", "photo5"}));
}

TEST(Resample, TakesMaskedPixelsForNoData) {
  auto made = SphereCapture(SmoothColor, {0, 0, 0}, 6, 1);
  Image mask(240, 180, 1, PixelType::kUint8, ColorEncoding::kSrgb);  // the left half only
  for (int y = 0; y < 180; ++y) {
    for (int x = 0; x < 120; ++x) mask.At<uint8_t>(x, y) = 255;
  }
  made.pictures["mask.png"] = mask;
  made.capture.photos[2].mask = "mask.png";
  const auto file = test::TestFolder("mask") / "light_field.lfs";
  ResampleSphere(made, WholeTriangles(), file);
  const LightField field = LightField::Open(file);
  int seen = 0;
  for (int t = 0; t < field.triangle_count(); ++t) {
    const auto photos = field.Patch(t).photos;
    if (std::find(photos.begin(), photos.end(), 2) == photos.end()) continue;
    ++seen;
    for (int c = 0; c < 3; ++c) {
      const auto pixel =
          Project(made.calib.cameras["camera"],
                  made.calib.photos[2].camera_from_world *
                      field.mesh().vertices[static_cast<size_t>(field.mesh().triangles[t][c])]);
      EXPECT_LE(pixel->x(), 119);
    }
  }
  EXPECT_GT(seen, 5);
}

// The left half of one float picture is NaN, an infinite pixel saturates, linear values from 1e-6
// to 1e6 stay values.
TEST(Resample, TakesPixelsThatAreNoNumbersForNoData) {
  auto made = SphereCapture(SmoothColor, {0, 0, 0}, 6, 1);
  Image picture = ToLinearFloat(made.pictures.at(made.capture.photos[2].file));
  for (int y = 0; y < picture.height(); ++y) {
    for (int x = 0; x < 120; ++x) picture.At<float>(x, y, x % 3) = std::nanf("");
    picture.At<float>(150, y, 0) = HUGE_VALF;
    picture.At<float>(155, y, 1) = 1e6F;
    picture.At<float>(160, y, 2) = 1e-6F;
  }
  made.pictures[made.capture.photos[2].file] = picture;
  const auto file = test::TestFolder("no_number") / "light_field.lfs";
  const ResampleResult result = ResampleSphere(made, WholeTriangles(), file);
  EXPECT_GT(result.saturated_share, 0);
  const LightField field = LightField::Open(file);
  int seen = 0;
  for (int t = 0; t < field.triangle_count(); ++t) {
    const auto photos = field.Patch(t).photos;
    if (std::find(photos.begin(), photos.end(), 2) == photos.end()) continue;
    ++seen;
    Eigen::Vector2d middle = Eigen::Vector2d::Zero();
    for (int c = 0; c < 3; ++c) {
      middle +=
          *Project(made.calib.cameras["camera"],
                   made.calib.photos[2].camera_from_world *
                       field.mesh().vertices[static_cast<size_t>(field.mesh().triangles[t][c])]) /
          3;
    }
    EXPECT_GT(middle.x(), 119) << "at most half of a triangle may be estimated";
  }
  EXPECT_GT(seen, 5);
}

TEST(Resample, WritesTrianglesThatNobodySees) {
  auto made = SphereCapture(SmoothColor, {0, 0, 0}, 1, 1);
  made.calib.photos[0].camera_from_world = LookAt({0, 0, 900}, {0, 0, 1800}, {0, 1, 0});
  const auto file = test::TestFolder("unseen") / "light_field.lfs";
  const ResampleResult result = ResampleSphere(made, SmallOptions(), file);
  EXPECT_EQ(result.unseen_triangles, 320);
  EXPECT_EQ(result.mean_visible_views, 0);
  EXPECT_EQ(result.seen_directions_share, 0);
  const LightField field = LightField::Open(file);
  LightField::WeightBuffer buffer;
  EXPECT_TRUE(field.Weights(5, 1, buffer).view.empty());
  EXPECT_TRUE(field.Patch(5).values.empty());
}

class BadInput : public testing::Test {
 protected:
  void ExpectError(const std::string& part) {
    const auto folder = test::TestFolder("bad_input");
    try {
      Resample(made.capture, made.calib, surface, mesh, made.Loader(), options,
               folder / "light_field.lfs", SilentProgress());
      FAIL() << "no error: " << part;
    } catch (const Error& error) {
      EXPECT_NE(std::string(error.what()).find(part), std::string::npos) << error.what();
    }
    EXPECT_TRUE(std::filesystem::is_empty(folder));
  }

  test::MemoryCapture made = SphereCapture(SmoothColor, {0, 0, 0}, 2, 1);
  TriangleMesh surface = test::Sphere({0, 0, 0}, kRadius, 3);
  TriangleMesh mesh = test::Sphere({0, 0, 0}, kRadius, 1);
  ResampleOptions options = SmallOptions();
};

TEST_F(BadInput, NoPhotographs) {
  made.calib.photos.clear();
  ExpectError("no train photograph");
}
TEST_F(BadInput, PhotographOfAnotherSize) {
  made.pictures["photo1.png"] = Image(10, 10, 3, PixelType::kUint8, ColorEncoding::kSrgb);
  ExpectError("photo1.png: is 10 x 10 pixels");
}
TEST_F(BadInput, MaskOfAnotherSize) {
  made.capture.photos[0].mask = "mask.png";
  made.pictures["mask.png"] = Image(10, 10, 1, PixelType::kUint8, ColorEncoding::kSrgb);
  ExpectError("mask.png");
}
TEST_F(BadInput, PoseOfAnUnknownPhotograph) {
  made.calib.photos[1].id = "stranger";
  ExpectError("stranger");
}
TEST_F(BadInput, CameraWithoutIntrinsics) {
  made.calib.cameras.clear();
  ExpectError("no intrinsics");
}
TEST_F(BadInput, PoseThatIsNotFinite) {
  made.calib.photos[1].camera_from_world.translation.x() = std::nan("");
  ExpectError("photo1");
}
TEST_F(BadInput, CameraThatIsNotFinite) {
  made.calib.cameras["camera"].fx = std::nan("");
  ExpectError("photo0");
}
TEST_F(BadInput, EmptyMesh) {
  mesh = {};
  ExpectError("mesh");
}
TEST_F(BadInput, SurfaceThatIsNotFinite) {
  surface.vertices[3].y() = HUGE_VAL;
  ExpectError("surface");
}
TEST_F(BadInput, OptionOutOfRange) {
  options.view_grid = 1;
  ExpectError("view-grid");
}
TEST_F(BadInput, OptionNotANumber) {
  options.depth_margin_px = std::nan("");
  ExpectError("depth-margin-px");
}

TEST_F(BadInput, MissingPictureLeavesNoFile) {
  made.pictures.erase("photo1.png");
  const auto folder = test::TestFolder("missing_picture");
  EXPECT_ANY_THROW(Resample(made.capture, made.calib, surface, mesh, made.Loader(), options,
                            folder / "light_field.lfs", SilentProgress()));
  EXPECT_TRUE(std::filesystem::is_empty(folder));
}

/// Stops in the middle of the triangles, as Ctrl-C does.
class StopsAtTriangles : public Progress {
 public:
  void Start(std::string_view what, int64_t) override { stop_ = what == "resampling triangles"; }
  void Advance(int64_t) override {
    if (stop_) throw Interrupted();
  }
  void Note(std::string_view) override {}

 private:
  bool stop_ = false;
};

TEST(Resample, LeavesNoFileWhenInterrupted) {
  const auto made = SphereCapture(SmoothColor, {0, 0, 0}, 2, 1);
  const auto folder = test::TestFolder("interrupted");
  StopsAtTriangles progress;
  EXPECT_THROW(Resample(made.capture, made.calib, test::Sphere({0, 0, 0}, kRadius, 3),
                        test::Sphere({0, 0, 0}, kRadius, 1), made.Loader(), SmallOptions(),
                        folder / "light_field.lfs", progress),
               Interrupted);
  EXPECT_TRUE(std::filesystem::is_empty(folder));
}

}  // namespace
}  // namespace lfm
