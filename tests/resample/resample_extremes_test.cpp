// SPDX-License-Identifier: BSD-3-Clause
// Sizes at which memory decides.
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>

#include "core/atomic_file.h"
#include "core/error.h"
#include "core/process_memory.h"
#include "resample/light_field.h"
#include "resample/resample.h"
#include "test_scenes.h"

namespace lfm {
namespace {

constexpr int64_t kMib = int64_t{1} << 20;

Eigen::Vector3d SmoothColor(const Eigen::Vector3d& p) {
  return {0.45 + p.x() / 160, 0.45 + p.y() / 160, 0.4 + p.z() / 150};
}

int ResidentMib() { return static_cast<int>(ResidentMemoryBytes() / kMib); }

/// From here on PeakMemoryMib is that of what follows.
void ForgetPeak() { std::ofstream("/proc/self/clear_refs") << "5"; }

TriangleMesh CoarseTorus() { return test::Torus(40, 15, 200, 60); }

test::MemoryCapture TorusCapture(int photos, int width, int height) {
  return test::MakeCapture(CoarseTorus(), test::TestCamera(width, height, 1.3 * width),
                           test::PosesAround(photos, 260), SmoothColor, {0, 0, 0}, 1);
}

// With sanitizers, whose own memory would be measured, a fiftieth of the triangles.
TEST(ResampleExtremes, TwoMillionTrianglesWithinTheMemoryLimit) {
#if defined(__SANITIZE_ADDRESS__)
  constexpr int kAround = 200, kAcross = 100, kLimitMib = 16384;
#else
  constexpr int kAround = 2000, kAcross = 500, kLimitMib = 640;
#endif
  constexpr int kReadMib = 64;
  const auto made = TorusCapture(4, 320, 240);
  const auto file = test::TestFolder("two_million") / "light_field.lfs";
  ResampleOptions options;
  options.view_grid = 2;
  options.memory_mib = kLimitMib;
  ResampleResult result;
  {
    const TriangleMesh mesh = test::Torus(40, 15, kAround, kAcross);
    ASSERT_EQ(mesh.triangles.size(), size_t{2} * kAround * kAcross);
    ForgetPeak();
    result = Resample(made.capture, made.calib, CoarseTorus(), mesh, made.Loader(), options, file,
                      SilentProgress());
    RecordProperty("resampling_mib", static_cast<int>(PeakMemoryMib()));
    EXPECT_LT(PeakMemoryMib(), kLimitMib);
  }
  EXPECT_GT(result.mean_visible_views, 1);
  const int before_mib = ResidentMib();
  ForgetPeak();
  const LightField field = LightField::Open(file, kReadMib * kMib);
  int64_t views = 0, sum = 0;
  LightField::WeightBuffer buffer;
  for (int t = 0; t < field.triangle_count(); ++t) {
    const TrianglePatch patch = field.Patch(t);
    views += static_cast<int64_t>(patch.photos.size());
    for (const uint16_t value : patch.values) sum += value;
    for (int c = 0; c < 3; ++c)
      sum += static_cast<int64_t>(field.Weights(t, c, buffer).view.size());
  }
  EXPECT_NEAR(static_cast<double>(views) / field.triangle_count(), result.mean_visible_views, 1e-9);
  EXPECT_GT(sum, 0);
  const double tables_mib = 120.0 * static_cast<double>(field.mesh().vertices.size()) / kMib +
                            36.0 * field.triangle_count() / kMib;
  const double reading_mib = PeakMemoryMib() - before_mib;
  RecordProperty("tables_mib", static_cast<int>(tables_mib));
  RecordProperty("reading_mib", static_cast<int>(reading_mib));
  RecordProperty("file_mb", static_cast<int>(std::filesystem::file_size(file) / 1000000));
#if !defined(__SANITIZE_ADDRESS__)
  constexpr int kSlackMib = 64;
  EXPECT_GT(std::filesystem::file_size(file), size_t{5} * kReadMib * kMib);
  EXPECT_LT(reading_mib, kReadMib + tables_mib + kSlackMib);
#endif
}

// Photographs are put aside on disk, and looked at one by one.
TEST(ResampleExtremes, ATightLimitGivesTheSameBytes) {
  const auto made = TorusCapture(24, 480, 360);
  const TriangleMesh mesh = test::Torus(40, 15, 60, 24);
  const auto folder = test::TestFolder("tight");
  ResampleOptions options;
  options.view_grid = 8;
  std::vector<std::string> bytes;
  for (const bool tight : {false, true}) {
    options.memory_mib = tight ? ResidentMib() + 44 : 4096;
    Resample(made.capture, made.calib, CoarseTorus(), mesh, made.Loader(), options,
             folder / "light_field.lfs", SilentProgress());
    bytes.push_back(ReadFile(folder / "light_field.lfs"));
  }
  EXPECT_TRUE(bytes[0] == bytes[1]);
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder), {}), 1);
}

TEST(ResampleExtremes, ALimitThatIsTooLowNamesTheCure) {
  const auto made = TorusCapture(2, 960, 720);
  ResampleOptions options;
  options.memory_mib = std::max(64, ResidentMib() + 20);
  const auto folder = test::TestFolder("too_low");
  try {
    Resample(made.capture, made.calib, CoarseTorus(), CoarseTorus(), made.Loader(), options,
             folder / "light_field.lfs", SilentProgress());
    FAIL() << "was not refused";
  } catch (const Error& error) {
    const std::string text = error.what();
    EXPECT_NE(text.find("--memory-mib " + std::to_string(options.memory_mib) + ": looking at"),
              std::string::npos)
        << text;
    EXPECT_NE(text.find("allow that much, or take smaller photographs"), std::string::npos) << text;
    EXPECT_EQ(text.find('\n'), std::string::npos);
  }
  EXPECT_TRUE(std::filesystem::is_empty(folder));
}

}  // namespace
}  // namespace lfm
