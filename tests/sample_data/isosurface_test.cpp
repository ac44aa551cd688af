// SPDX-License-Identifier: BSD-3-Clause
#include "sample_data/isosurface.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/error.h"

namespace lfm {
namespace {

using V3 = Eigen::Vector3d;

const IsosurfaceGrid kGrid = {V3(-12, -12, -12), V3(12, 12, 12), 0.5};

TEST(Isosurface, SphereIsExactAndOrientedOutwards) {
  const TriangleMesh mesh =
      PolygoniseIsosurface([](const V3& p) { return p.norm() - 10; }, kGrid, 1);
  const double volume = 4.0 / 3 * std::numbers::pi * 1000;
  EXPECT_NEAR(SignedVolume(mesh) / volume, 1, 2e-3);
  for (size_t v = 0; v < mesh.vertices.size(); ++v) {
    ASSERT_NEAR(mesh.vertices[v].norm(), 10, 1e-6);
    ASSERT_GT(mesh.normals[v].dot(mesh.vertices[v].normalized()), 1 - 1e-6);
  }
}

// A slanted crossing of two tubes has cells with several sheets.
TEST(Isosurface, NearlyTouchingSheetsStayManifold) {
  const auto tubes = [](const V3& p) {
    const double a = std::hypot(p.y() - 2.45 - 0.1 * p.x(), p.z()) - 2.3;
    const double b = std::hypot(p.x() * 0.9 - 0.3 * p.y(), p.z() + 4.9) - 2.4;
    return std::max(std::min(a, b), p.norm() - 10);
  };
  const TriangleMesh mesh = PolygoniseIsosurface(tubes, kGrid, 1.5);
  const MeshTopology topology = ExamineTopology(mesh);
  EXPECT_TRUE(topology.closed && topology.manifold);
}

// A waved sheet thinner than the cells: torn, but each piece closed.
TEST(Isosurface, SheetThinnerThanItsCellsStaysManifold) {
  const auto sheet = [](const V3& p) {
    const double wave = std::sin(0.9 * p.x()) * std::cos(0.7 * p.y() + 0.2 * p.x());
    return std::max(0.6 * (std::abs(p.z() - wave) - 0.28), p.norm() - 10);
  };
  for (const double cell : {0.5, 0.63, 0.77, 0.9, 1.1}) {
    IsosurfaceGrid grid = kGrid;
    grid.cell_mm = cell;
    const MeshTopology topology = ExamineTopology(PolygoniseIsosurface(sheet, grid, 1.5));
    EXPECT_TRUE(topology.closed && topology.manifold) << cell;
  }
}

TEST(Isosurface, RejectsWhatItCannotClose) {
  EXPECT_THROW(PolygoniseIsosurface([](const V3& p) { return p.norm() - 20; }, kGrid, 1), Error);
  EXPECT_THROW(PolygoniseIsosurface([](const V3&) { return 5.0; }, kGrid, 1), Error);
  IsosurfaceGrid bad = kGrid;
  bad.cell_mm = 0;
  EXPECT_THROW(PolygoniseIsosurface([](const V3& p) { return p.norm() - 10; }, bad, 1), Error);
}

}  // namespace
}  // namespace lfm
