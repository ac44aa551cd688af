// SPDX-License-Identifier: BSD-3-Clause
#include "encode/edge_links.h"

#include <gtest/gtest.h>

#include "resample/light_field.h"
#include "tests/encode/synthetic_light_field.h"

namespace lfm::testing {
namespace {

Eigen::Vector3d PointOf(const TriangleMesh& mesh, int triangle, int n, const Eigen::Vector2i& at) {
  const Eigen::Vector3d weights = PatchSampleWeights(n, at.x(), at.y());
  Eigen::Vector3d p = Eigen::Vector3d::Zero();
  for (int c = 0; c < 3; ++c) p += weights[c] * mesh.vertices[mesh.triangles[triangle][c]];
  return p;
}

// Both sides of a link are one point; sizes that do not divide each other too.
TEST(EdgeLinks, BothSidesAreOnePoint) {
  const TriangleMesh mesh = MakeSphere(1);
  std::vector<int> edge_samples;
  size_t expected = 0;
  for (size_t t = 0; t < mesh.triangles.size(); ++t) {
    edge_samples.push_back(t % 3 == 0 ? 9 : t % 3 == 1 ? 5 : 4);
    expected += size_t{3} * edge_samples.back();
  }
  const auto links = FindEdgeLinks(mesh, edge_samples, PatchChannels::kCorners);
  EXPECT_EQ(links.size(), expected);  // the sphere is closed
  for (const EdgeLink& link : links) {
    const int n = edge_samples[link.neighbor];
    const Eigen::Vector3d own = PointOf(mesh, link.triangle, edge_samples[link.triangle], link.own);
    const Eigen::Vector3d other =
        (1 - link.share) * PointOf(mesh, link.neighbor, n, link.other[0]) +
        link.share * PointOf(mesh, link.neighbor, n, link.other[1]);
    EXPECT_LE((own - other).norm(), 1e-4);
    int off_the_edge = 0;
    for (int c = 0; c < 3; ++c) {
      if (link.channels[c] < 0) {
        ++off_the_edge;
        continue;
      }
      EXPECT_EQ(mesh.triangles[link.neighbor][link.channels[c]], mesh.triangles[link.triangle][c]);
    }
    EXPECT_EQ(off_the_edge, 1);
  }
}

TEST(EdgeLinks, WhoHasNoPatchHasNoLinks) {
  const TriangleMesh mesh = MakeSphere(0);
  std::vector<int> edge_samples(mesh.triangles.size(), 5);
  edge_samples[0] = 0;
  for (const EdgeLink& link : FindEdgeLinks(mesh, edge_samples, PatchChannels::kColors)) {
    EXPECT_NE(link.triangle, 0);
    EXPECT_NE(link.neighbor, 0);
    EXPECT_EQ(link.channels, (std::array<int, 3>{0, 1, 2}));
  }
  std::vector<int> one(mesh.triangles.size(), 0);
  one[3] = 5;
  EXPECT_TRUE(FindEdgeLinks(mesh, one, PatchChannels::kColors).empty());
}

}  // namespace
}  // namespace lfm::testing
