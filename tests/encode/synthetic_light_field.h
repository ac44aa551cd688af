// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <array>
#include <functional>
#include <vector>

#include "encode/light_field_source.h"

namespace lfm::testing {

/// A light field made in memory.
struct SyntheticLightField {
  struct Triangle {
    int edge_samples = 2;
    std::vector<uint16_t> photos;
    std::vector<uint16_t> values;
    std::array<LightField::WeightBuffer, 3> weights;
  };
  TriangleMesh mesh;
  std::vector<Eigen::Matrix3d> frames;
  DirectionMap direction_map = DirectionMap::kHemiOctahedral;
  int grid = 8;
  std::vector<Triangle> triangles;

  /// Lives as long as this does.
  LightFieldSource Source() const;
};

/// Octahedron, subdivided `levels` times and pushed to a sphere of radius 50 mm.
TriangleMesh MakeSphere(int levels);

/// `count` unit directions, spread evenly: those of MakeLightField's views.
std::vector<Eigen::Vector3d> SpreadDirections(int count);

/// sRGB-coded colour of surface point `p` seen from unit direction `to_eye`.
using Appearance =
    std::function<Eigen::Vector3d(const Eigen::Vector3d& p, const Eigen::Vector3d& to_eye)>;

/// Whether a view at this cosine from a triangle's normal sees it.
using ViewFilter = std::function<bool(double cosine)>;
inline bool InFront(double cosine) { return cosine > 0.2; }

/// A light field of `mesh` under `views` directions spread around it (a triangle is seen by those
/// that `sees` lets through). Triangle t has edge_samples(t) samples an edge. Grid directions blend
/// the three nearest views with weights by distance.
SyntheticLightField MakeLightField(const TriangleMesh& mesh, int grid, int views,
                                   const std::function<int(int triangle)>& edge_samples,
                                   const Appearance& appearance, const ViewFilter& sees = InFront);

/// A textured, glossy surface lit from above.
Eigen::Vector3d GlossyAppearance(const Eigen::Vector3d& p, const Eigen::Vector3d& to_eye);

/// The dense resampled value of a sample: sum over the three views of a grid direction.
double ResampledValue(const SyntheticLightField& field, int triangle, int corner, int sample,
                      int channel, int direction);

}  // namespace lfm::testing
