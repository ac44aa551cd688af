// SPDX-License-Identifier: BSD-3-Clause
#include "core/half_edges.h"

#include <gtest/gtest.h>

#include "mesh_zoo.h"

namespace lfm {
namespace {

TEST(HalfEdges, OfATetrahedronComeInPairsThatRunOppositeWays) {
  const TriangleMesh mesh = Tetrahedron();
  const std::vector<HalfEdge> sorted = SortedHalfEdges(mesh);
  ASSERT_EQ(sorted.size(), 12u);
  for (size_t i = 0; i < sorted.size(); ++i) {
    const HalfEdge& h = sorted[i];
    EXPECT_EQ(mesh.triangles[h.triangle][h.edge], h.from);
    EXPECT_EQ(mesh.triangles[h.triangle][(h.edge + 1) % 3], h.to);
    EXPECT_EQ(h.Forward(), h.from < h.to);
    EXPECT_EQ(h.Corner(), 3 * h.triangle + h.edge);
    EXPECT_TRUE(SameEdge(h, sorted[i ^ 1]));
    EXPECT_NE(h.Forward(), sorted[i ^ 1].Forward());
    const bool first_of_pair = i % 2 == 0;
    if (first_of_pair && i > 0) {
      EXPECT_FALSE(SameEdge(h, sorted[i - 1]));
    }
  }
  EXPECT_TRUE(SortedHalfEdges({}).empty());
}

}  // namespace
}  // namespace lfm
