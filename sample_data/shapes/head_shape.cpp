// SPDX-License-Identifier: BSD-3-Clause
#include "sample_data/shapes/head_shape.h"

#include "sample_data/bust_shape.h"
#include "sample_data/shapes/implicit.h"

namespace lfm {
namespace {

using V3 = Eigen::Vector3d;

constexpr double kScale = 1.7;  // of the bust's head

double Skin(const V3& p) {
  const V3 q = p / kScale;
  double neck = Limb(q, {0, 6, -42}, {0, 3, -14}, 12.5, 11);
  neck = SmoothUnion(neck, Limb(Mirrored(q), {9.5, 5, -15}, {3, -7, -38}, 2.2, 1.9), 3.5);
  const double d = SmoothUnion(BustFaceDistance(q), neck, 3.5);
  return kScale * SmoothIntersection(d, -32 - q.z(), 0.8);
}

// A wig: hollow where the skull is, whose hair would be all folds there.
double Hair(const V3& p) {
  const V3 q = p / kScale;
  const double skull = Ellipsoid(q, {0, 2, 8}, {17, 21, 18.5});
  return kScale * SmoothIntersection(BustHairDistance(q) - 0.8, -skull, 0.6);
}

}  // namespace

Shape MakeHead(HeadPart part, double edge_mm) {
  if (part == HeadPart::kSkin) {
    return PolygoniseShape(Skin, {-44, -48, -56}, {44, 44, 52}, edge_mm, 2);
  }
  return PolygoniseShape(Hair, {-44, -46, -44}, {44, 66, 60}, edge_mm, 3);
}

}  // namespace lfm
