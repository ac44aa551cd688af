// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/reconstruction.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <string_view>
#include <vector>

#include "core/error.h"
#include "core/progress.h"
#include "mesh/cleaning.h"
#include "mesh/surface_distance.h"
#include "tests/mesh/test_shapes.h"

namespace lfm {
namespace {

constexpr int kDepth = 6;

const FreeSpace kNothingKnown({}, {}, 1);

TriangleMesh Reconstruct(const PointCloud& cloud, int depth = kDepth) {
  const CleanCloud clean = CleanPoints(cloud, {});
  return ReconstructSurface(clean.cloud, clean.spacing_mm, {SurfaceMethod::kAuto, depth},
                            kNothingKnown, SilentProgress())
      .mesh;
}

void ExpectSoundSurface(const TriangleMesh& mesh) {
  EXPECT_TRUE(test::IsClosedManifold(mesh));
  EXPECT_EQ(ExamineTopology(mesh).components, 1);
  EXPECT_EQ(ExamineTopology(mesh).degenerate_triangles, 0);
  EXPECT_GT(SignedVolume(mesh), 0);
  ASSERT_EQ(mesh.confidence.size(), mesh.vertices.size());
  ASSERT_EQ(mesh.normals.size(), mesh.vertices.size());
  double lowest = 1e9;
  for (size_t v = 0; v < mesh.vertices.size(); ++v) {
    lowest = std::min(lowest, mesh.vertices[v].z());
    EXPECT_NEAR(mesh.normals[v].norm(), 1, 1e-9);
    EXPECT_TRUE(mesh.confidence[v] >= 0 && mesh.confidence[v] <= 1);
    if (mesh.vertices[v].z() == 0) {
      EXPECT_EQ(mesh.confidence[v], 0);
    }
  }
  EXPECT_EQ(lowest, 0);
}

// Distances of the true surface's part above `from_z` from the mesh, and back.
void ExpectNear(const TriangleMesh& mesh, const TriangleMesh& truth, double from_z, double mean_abs,
                double p95_abs) {
  for (int direction = 0; direction < 2; ++direction) {
    const TriangleMesh& from = direction ? mesh : truth;
    std::vector<Eigen::Vector3d> points;
    for (const auto& p : SampleSurface(from, 20000, 5).points) {
      if (p.z() > from_z) points.push_back(p);
    }
    const auto s = SummarizeDistances(DistancesToMesh(points, direction ? truth : mesh));
    EXPECT_LT(s.mean, mean_abs) << direction;
    EXPECT_LT(s.p95, p95_abs) << direction;
  }
}

TEST(Reconstruction, EllipsoidThatStandsOnThePlatform) {
  TriangleMesh truth = test::MakeSphere(1, 5);
  for (auto& v : truth.vertices) v = {25 * v.x(), 30 * v.y(), 40 + 40 * v.z()};
  PointCloud cloud = test::MeasureCloud(truth, 120000);
  test::AddPlatform(cloud, 20000, 90, 32, 0.1, 2);
  test::AddOutliers(cloud, 200, 90, 90, 3);
  const TriangleMesh mesh = Reconstruct(cloud, 7);
  ExpectSoundSurface(mesh);
  ExpectNear(mesh, truth, 6, 0.02, 0.05);
  int sides = 0, sides_without = 0;
  for (size_t v = 0; v < mesh.vertices.size(); ++v) {
    if (mesh.vertices[v].z() < 8) continue;
    ++sides;
    sides_without += mesh.confidence[v] == 0;
  }
  EXPECT_GT(sides, 3000);
  EXPECT_EQ(sides_without, 0);
}

TEST(Reconstruction, BoxWallsGoStraightDownToThePlatform) {
  const TriangleMesh truth = test::MakeBox({-20, -15, 0}, {20, 15, 50}, 4);
  const TriangleMesh mesh = Reconstruct(test::MeasureCloud(truth, 60000));
  ExpectSoundSurface(mesh);
  double base = 0;
  for (size_t t = 0; t < mesh.triangles.size(); ++t) {
    const int i = static_cast<int>(t);
    if (TriangleNormal(mesh, i).z() < -0.99) base += TriangleArea(mesh, i);
  }
  EXPECT_NEAR(base, 40 * 30, 0.02 * 40 * 30);
  EXPECT_NEAR(SignedVolume(mesh), 40 * 30 * 50, 0.005 * 40 * 30 * 50);
  // The wall below the lowest measured point, too.
  ExpectNear(mesh, truth, 0.05, 0.06, 0.3);
}

TEST(Reconstruction, TorusKeepsItsHandle) {
  const TriangleMesh truth = test::MakeTorus(30, 10, 10, 120, 60);
  const TriangleMesh mesh = Reconstruct(test::MeasureCloud(truth, 60000));
  ExpectSoundSurface(mesh);
  EXPECT_EQ(2 * mesh.vertices.size(), mesh.triangles.size());
  ExpectNear(mesh, truth, 4, 0.04, 0.12);
}

TEST(Reconstruction, HoleInTheDataIsClosedWithoutConfidence) {
  const TriangleMesh truth = test::MakeSphere(30, 5, {0, 0, 30});
  PointCloud cloud = test::MeasureCloud(truth, 40000), holed;
  const Eigen::Vector3d hole(30, 0, 30);
  for (size_t i = 0; i < cloud.points.size(); ++i) {
    if ((cloud.points[i] - hole).norm() < 8) continue;
    holed.points.push_back(cloud.points[i]);
    holed.normals.push_back(cloud.normals[i]);
    holed.confidence.push_back(cloud.confidence[i]);
  }
  const TriangleMesh mesh = Reconstruct(holed);
  ExpectSoundSurface(mesh);
  int inside = 0;
  for (size_t v = 0; v < mesh.vertices.size(); ++v) {
    if ((mesh.vertices[v] - hole).norm() > 5) continue;
    ++inside;
    EXPECT_EQ(mesh.confidence[v], 0);
    EXPECT_NEAR((mesh.vertices[v] - Eigen::Vector3d(0, 0, 30)).norm(), 30, 1.0);
  }
  EXPECT_GT(inside, 10);  // the octree is coarse where there is no data
}

TEST(Reconstruction, FinerDepthFinerMesh) {
  const PointCloud cloud = test::MeasureCloud(test::MakeSphere(30, 5, {0, 0, 30}), 60000);
  const size_t coarse = Reconstruct(cloud, 5).triangles.size();
  const size_t fine = Reconstruct(cloud, 6).triangles.size();
  EXPECT_GT(fine, 3 * coarse);
  EXPECT_LT(fine, 6 * coarse);
}

class Recorder : public Progress {
 public:
  explicit Recorder(int interrupt_at = 1 << 20) : interrupt_at_(interrupt_at) {}
  void Start(std::string_view, int64_t total) override { total_ = total; }
  void Advance(int64_t steps) override {
    if (++calls_ >= interrupt_at_) throw Interrupted();
    done_ += steps;
  }
  void Note(std::string_view line) override { notes.emplace_back(line); }
  bool Complete() const { return done_ == total_; }

  std::vector<std::string> notes;

 private:
  int interrupt_at_, calls_ = 0;
  int64_t total_ = 0, done_ = 0;
};

// A single sheet high above the platform: Poisson leaves it open at the cube's walls.
PointCloud Sheet() {
  PointCloud sheet;
  for (int i = 0; i < 1600; ++i) {
    sheet.points.emplace_back(i % 40 - 20, i / 40 - 20, 40);
    sheet.normals.emplace_back(0, 0, 1);
    sheet.confidence.push_back(1);
  }
  return sheet;
}

TEST(Reconstruction, WrapStepsInWherePoissonStaysOpen) {
  Recorder progress;
  const ReconstructedSurface surface =
      ReconstructSurface(Sheet(), 1, {SurfaceMethod::kAuto, 5}, kNothingKnown, progress);
  EXPECT_EQ(surface.method, SurfaceMethod::kWrap);
  ASSERT_EQ(surface.reasons.size(), 4u);
  EXPECT_NE(surface.reasons[1].find("poisson left no closed surface"), std::string::npos);
  EXPECT_EQ(progress.notes, std::vector<std::string>({surface.reasons[1], surface.reasons[2]}));
  EXPECT_TRUE(test::IsClosedManifold(surface.mesh));
  EXPECT_THROW(
      ReconstructSurface(Sheet(), 1, {SurfaceMethod::kPoisson, 5}, kNothingKnown, progress), Error);
}

TEST(Reconstruction, IsInterruptedBetweenSteps) {
  Recorder progress(2);
  EXPECT_THROW(ReconstructSurface(Sheet(), 1, {SurfaceMethod::kWrap, 5}, kNothingKnown, progress),
               Interrupted);
}

TEST(Reconstruction, BothMethodsAgreeOnWhatWasMeasured) {
  const TriangleMesh truth = test::MakeTorus(30, 10, 10, 120, 60);
  const CleanCloud clean = CleanPoints(test::MeasureCloud(truth, 60000), {});
  for (const SurfaceMethod method : {SurfaceMethod::kPoisson, SurfaceMethod::kWrap}) {
    const ReconstructedSurface surface = ReconstructSurface(
        clean.cloud, clean.spacing_mm, {method, kDepth}, kNothingKnown, SilentProgress());
    EXPECT_EQ(surface.method, method);
    EXPECT_EQ(surface.reasons.front(), std::string(NameOf(method)) + ": as asked");
    ExpectSoundSurface(surface.mesh);
    EXPECT_EQ(surface.self_intersections, 0);
    // A wrap's facets are up to three cells about: 3.9 mm, and 0.8 mm off a tube of radius 10.
    const bool wrapped = method == SurfaceMethod::kWrap;
    ExpectNear(surface.mesh, truth, 4, wrapped ? 0.12 : 0.08, wrapped ? 0.35 : 0.25);
  }
}

TEST(Reconstruction, CountsToTheEndWhateverTheAttemptsWere) {
  Recorder progress;
  const CleanCloud clean =
      CleanPoints(test::MeasureCloud(test::MakeSphere(30, 4, {0, 0, 30}), 15000), {});
  ReconstructSurface(clean.cloud, clean.spacing_mm, {SurfaceMethod::kAuto, 5}, kNothingKnown,
                     progress);
  EXPECT_TRUE(progress.Complete());
}

TEST(Reconstruction, NoPointsIsAnError) {
  EXPECT_NE(
      test::ErrorOf([] {
        ReconstructSurface({}, 0.1, {SurfaceMethod::kAuto, 6}, kNothingKnown, SilentProgress());
      }),
      "");
}

}  // namespace
}  // namespace lfm
