// SPDX-License-Identifier: BSD-3-Clause
#include "viewer/vertex_coverage.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <atomic>
#include <cmath>
#include <numbers>

#include "core/error.h"
#include "core/parallel.h"
#include "synthetic_model.h"

namespace lfm {
namespace {

constexpr double kDegree = std::numbers::pi / 180;
const Eigen::Vector3d kCenter(5, -10, 70);
constexpr double kRadius = 50;

PosedCamera CameraAt(const Eigen::Vector3d& eye, const Eigen::Vector3d& target) {
  PosedCamera posed;
  posed.camera.width = 400;
  posed.camera.height = 300;
  posed.camera.fx = posed.camera.fy = 600;
  posed.camera.cx = 199.5;
  posed.camera.cy = 149.5;
  posed.camera_from_world = LookAt(eye, target, {0.1, 0.2, 1});
  return posed;
}

/// Cameras around the sphere; the last ones show a part of it, or look away from it.
std::vector<PosedCamera> CamerasAround() {
  std::vector<PosedCamera> cameras;
  for (int i = 0; i < 9; ++i) {
    const double azimuth = 40 * i * kDegree, elevation = (20 * (i % 4) - 30) * kDegree;
    const Eigen::Vector3d to_eye(std::cos(elevation) * std::cos(azimuth),
                                 std::cos(elevation) * std::sin(azimuth), std::sin(elevation));
    cameras.push_back(CameraAt(kCenter + (260 + 40 * i) * to_eye, kCenter));
  }
  cameras.push_back(CameraAt(kCenter + Eigen::Vector3d(200, 40, 30), kCenter));
  cameras.back().camera.cx = 390;
  cameras.push_back(CameraAt({300, 0, 70}, {600, 0, 70}));
  return cameras;
}

bool OnSensor(const PosedCamera& posed, const Eigen::Vector3d& point) {
  const Eigen::Vector3d p = posed.camera_from_world * point;
  const double u = posed.camera.fx * p.x() / p.z() + posed.camera.cx;
  const double v = posed.camera.fy * p.y() / p.z() + posed.camera.cy;
  return p.z() > 0 && u >= -0.5 && u < 399.5 && v >= -0.5 && v < 299.5;
}

/// The angle from the outward normal of a sphere's vertex to the eye.
double Grazing(const PosedCamera& posed, const Eigen::Vector3d& vertex) {
  const Eigen::Vector3d to_eye = posed.camera_from_world.Center() - vertex;
  return std::acos((vertex - kCenter).normalized().dot(to_eye.normalized()));
}

/// The largest angle between a triangle's normal and the sphere's at one of its corners.
double Facet(const TriangleMesh& sphere) {
  double largest = 0;
  for (size_t t = 0; t < sphere.triangles.size(); ++t) {
    const Eigen::Vector3d normal = TriangleNormal(sphere, static_cast<int>(t));
    for (int corner : sphere.triangles[t]) {
      const Eigen::Vector3d out = (sphere.vertices[corner] - kCenter).normalized();
      largest = std::max(largest, std::acos(std::min(1.0, normal.dot(out))));
    }
  }
  return largest;
}

TEST(CountPhotographs, CountsASphereUpToEightyDegrees) {
  const TriangleMesh sphere = MakeSphere(kRadius, kCenter, 4);
  const double facet = Facet(sphere);
  ASSERT_LT(facet, 3 * kDegree);
  const std::vector<PosedCamera> cameras = CamerasAround();
  const std::vector<int> counts = CountPhotographs(sphere, cameras, SilentProgress());
  ASSERT_EQ(counts.size(), sphere.vertices.size());
  int certain = 0, most = 0, cut_off = 0;
  for (size_t v = 0; v < counts.size(); ++v) {
    // Triangles lean to the normal by up to a facet: near 80 degrees a vertex may go either way.
    int at_least = 0, at_most = 0;
    for (const PosedCamera& camera : cameras) {
      const double grazing = Grazing(camera, sphere.vertices[v]);
      const bool on_sensor = OnSensor(camera, sphere.vertices[v]);
      at_least += on_sensor && grazing < 80 * kDegree - facet;
      at_most += on_sensor && grazing < 80 * kDegree + facet;
      cut_off += !on_sensor && grazing < 70 * kDegree;
    }
    EXPECT_GE(counts[v], at_least) << v;
    EXPECT_LE(counts[v], at_most) << v;
    certain += at_least == at_most;
    most = std::max(most, counts[v]);
  }
  EXPECT_GT(certain, static_cast<int>(counts.size()) / 2);
  EXPECT_GT(cut_off, static_cast<int>(counts.size()) / 20);
  EXPECT_GE(most, 3);
}

TEST(CountPhotographs, OneTriangleThatFacesByLessThanEightyDegreesSuffices) {
  TriangleMesh flat;
  flat.vertices = {{0, 0, 0}, {0, 0.01, 0}, {-0.01, 0, 0}};
  flat.triangles = {{0, 1, 2}};
  TriangleMesh roof = flat;  // its other side falls off steeply
  roof.vertices.push_back({0.001, 0, -0.01});
  roof.triangles.push_back({0, 3, 1});
  for (const double grazing_deg : {0.0, 79.9, 80.1, 89.9, 100.0}) {
    const double grazing = grazing_deg * kDegree;
    const std::vector<PosedCamera> cameras = {
        CameraAt({-300 * std::sin(grazing), 0, 300 * std::cos(grazing)}, {0, 0, 0})};
    const int expected = grazing_deg < 80 ? 1 : 0;
    EXPECT_EQ(CountPhotographs(flat, cameras, SilentProgress())[0], expected) << grazing_deg;
    const std::vector<int> counts = CountPhotographs(roof, cameras, SilentProgress());
    EXPECT_EQ(counts[0], expected) << grazing_deg;
    EXPECT_EQ(counts[3], 0) << grazing_deg;
  }
}

/// A square of 2 * half mm a side at height z, of `steps` cells a side, facing up or down.
void AddSquare(double half, double z, int steps, bool up, TriangleMesh& mesh) {
  const int first = static_cast<int>(mesh.vertices.size()), row = steps + 1;
  for (int j = 0; j <= steps; ++j) {
    for (int i = 0; i <= steps; ++i) {
      mesh.vertices.push_back({2 * half * i / steps - half, 2 * half * j / steps - half, z});
    }
  }
  for (int j = 0; j < steps; ++j) {
    for (int i = 0; i < steps; ++i) {
      const int a = first + j * row + i, b = a + 1, c = a + row + 1, d = a + row;
      mesh.triangles.push_back(up ? Eigen::Vector3i(a, b, c) : Eigen::Vector3i(a, c, b));
      mesh.triangles.push_back(up ? Eigen::Vector3i(a, c, d) : Eigen::Vector3i(a, d, c));
    }
  }
}

TEST(CountPhotographs, HidesWhatLiesInTheShadowOfAnother) {
  TriangleMesh mesh;
  AddSquare(80, 0, 40, true, mesh);
  const size_t floor = mesh.vertices.size();
  AddSquare(20, 100, 3, false, mesh);
  // The third camera is below the floor, the fourth looks from the floor at the lid's front.
  const Eigen::Vector3d above(0, 0, 300), aside(150, 0, 300);
  const std::vector<PosedCamera> cameras = {CameraAt(above, {0, 0, 0}), CameraAt(aside, {0, 0, 0}),
                                            CameraAt({0, 0, -300}, {0, 0, 0}),
                                            CameraAt({0, 0, 20}, {0, 0, 100})};
  int hidden_above = 0, hidden_aside = 0, on_lid = 0;
  std::vector<int> expected;
  for (size_t v = 0; v < mesh.vertices.size(); ++v) {
    const Eigen::Vector3d& p = mesh.vertices[v];
    if (v >= floor) {
      expected.push_back(OnSensor(cameras[3], p));
      on_lid += expected.back();
      continue;
    }
    const auto under_lid = [&](const Eigen::Vector3d& eye) {
      const Eigen::Vector3d at_lid = p + 100 / eye.z() * (eye - p);
      return std::abs(at_lid.x()) < 20 && std::abs(at_lid.y()) < 20;
    };
    hidden_above += under_lid(above);
    hidden_aside += under_lid(aside);
    expected.push_back((!under_lid(above) && OnSensor(cameras[0], p)) +
                       (!under_lid(aside) && OnSensor(cameras[1], p)));
  }
  EXPECT_EQ(CountPhotographs(mesh, cameras, SilentProgress()), expected);
  EXPECT_GT(hidden_above, 100);
  EXPECT_GT(hidden_aside, 50);
  EXPECT_GT(on_lid, 8);
}

TEST(CountPhotographs, ThinWallsHideAndTrianglesWithoutAreaFaceNobody) {
  TriangleMesh mesh;
  AddSquare(40, 0, 4, true, mesh);
  AddSquare(40, 0.1, 4, false, mesh);  // a wall of 0.1 mm, both of its sides turned inwards
  const int apart = static_cast<int>(mesh.vertices.size());
  mesh.vertices.insert(mesh.vertices.end(), {{0, 0, 30}, {1, 0, 30}, {2, 0, 30}});
  mesh.triangles.push_back({apart, apart + 1, apart + 2});
  const std::vector<PosedCamera> cameras = {CameraAt({200, 20, 300}, {0, 0, 0}),
                                            CameraAt({200, 20, -300}, {0, 0, 0})};
  const std::vector<int> counts = CountPhotographs(mesh, cameras, SilentProgress());
  for (size_t v = 0; v < counts.size(); ++v) {
    // But for the rim, which is seen past the other side.
    const Eigen::Vector3d& p = mesh.vertices[v];
    if (std::abs(p.x()) < 40 && std::abs(p.y()) < 40) {
      EXPECT_EQ(counts[v], 0) << p.transpose();
    }
  }
  EXPECT_GT(*std::max_element(counts.begin(), counts.end()), 0);
}

TEST(CountPhotographs, VerticesWithoutATriangleAreSeenByNobody) {
  TriangleMesh mesh;
  AddSquare(40, 0, 2, true, mesh);
  mesh.vertices.push_back({0, 0, 50});
  mesh.vertices.push_back({30, 0, 50});
  const std::vector<PosedCamera> cameras = {CameraAt({10, 20, 300}, {0, 0, 0}),
                                            CameraAt({-10, 0, 300}, {0, 0, 0})};
  const std::vector<int> counts = CountPhotographs(mesh, cameras, SilentProgress());
  ASSERT_EQ(counts.size(), 11u);
  for (size_t v = 0; v < 9; ++v) EXPECT_EQ(counts[v], 2) << v;
  EXPECT_EQ(counts[9], 0);
  EXPECT_EQ(counts[10], 0);
}

TEST(CountPhotographs, WithoutCamerasNothingIsSeenAndWithoutTrianglesItRefuses) {
  TriangleMesh mesh;
  AddSquare(40, 0, 2, true, mesh);
  EXPECT_EQ(CountPhotographs(mesh, {}, SilentProgress()), std::vector<int>(9, 0));
  mesh.triangles.push_back({0, 1, 9});
  EXPECT_THROW(CountPhotographs(mesh, {}, SilentProgress()), Error);
  mesh.triangles.clear();
  EXPECT_THROW(CountPhotographs(mesh, {}, SilentProgress()), Error);
}

struct CountingProgress : Progress {
  void Start(std::string_view, int64_t steps) override { total = steps; }
  void Advance(int64_t steps) override {
    done += steps;
    if (done > most) throw Interrupted();
  }
  void Note(std::string_view) override {}

  int64_t total = 0, most = 1 << 30;
  std::atomic<int64_t> done{0};
};

TEST(CountPhotographs, TellsItsProgressAndDoesNotDependOnTheThreads) {
  const TriangleMesh sphere = MakeSphere(kRadius, kCenter, 4);
  const std::vector<PosedCamera> cameras = CamerasAround();
  CountingProgress progress;
  const std::vector<int> several = CountPhotographs(sphere, cameras, progress);
  EXPECT_EQ(progress.total, static_cast<int64_t>(sphere.vertices.size()));
  EXPECT_EQ(progress.done, progress.total);
  SetThreadCount(1);
  EXPECT_EQ(CountPhotographs(sphere, cameras, SilentProgress()), several);
  SetThreadCount(0);
  CountingProgress stopped;
  stopped.most = 0;
  EXPECT_THROW(CountPhotographs(sphere, cameras, stopped), Interrupted);
}

}  // namespace
}  // namespace lfm
