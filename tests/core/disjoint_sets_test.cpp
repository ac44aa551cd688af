// SPDX-License-Identifier: BSD-3-Clause
#include "core/disjoint_sets.h"

#include <gtest/gtest.h>

namespace lfm {
namespace {

TEST(DisjointSets, GoByTheirLeastMember) {
  DisjointSets sets(7);
  sets.Unite(6, 4);
  sets.Unite(4, 5);
  sets.Unite(1, 2);
  for (int i : {4, 5, 6}) EXPECT_EQ(sets.Find(i), 4);
  EXPECT_EQ(sets.Find(2), 1);
  EXPECT_EQ(sets.Find(0), 0);
  EXPECT_EQ(sets.Find(3), 3);
  sets.Unite(2, 6);
  sets.Unite(5, 1);  // they are one already
  for (int i : {1, 2, 4, 5, 6}) EXPECT_EQ(sets.Find(i), 1);
}

}  // namespace
}  // namespace lfm
