// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "calib/calib.h"
#include "core/triangle_mesh.h"
#include "resample/direction_map.h"
#include "resample/light_field.h"

namespace lfm {

/// What the factorisation reads of a resampled light field: a LightField file, or data in memory.
///
/// `patch` and `weights` are called from many threads at once. The references live as long as the
/// source.
struct LightFieldSource {
  const TriangleMesh& mesh;                           ///< mm, world frame
  const std::vector<Eigen::Matrix3d>& vertex_frames;  ///< one a vertex
  DirectionMap direction_map = DirectionMap::kHemiOctahedral;
  int grid = 32;  ///< directions a side
  std::function<TrianglePatch(int triangle)> patch;
  std::function<ViewWeights(int triangle, int corner, LightField::WeightBuffer& buffer)> weights;
  int64_t dense_bytes = 0;  ///< 3 x samples x grid^2, over all triangles
  /// Where the photographs of the patches were taken, mm, world frame; empty when not known.
  std::vector<Eigen::Vector3d> eyes = {};
  /// What is added to a triangle's blended views in the directions of a corner's grid: 9 grid^2
  /// values, sRGB-coded (reflection_model.h). `change[(3 at + channel) * grid^2 + direction]` is
  /// added at corner `at`, and between the corners linearly. Not set: nothing.
  std::function<std::vector<float>(int triangle, int corner, const ViewWeights& weights)> change =
      {};
  std::string name = "light field";  ///< what messages begin with: the file's

  /// Throws Error: the name, the problem, and that resampling again is the cure.
  [[noreturn]] void Fail(const std::string& problem) const;
};

/// The source behind an open file; `light_field` must outlive it. `eyes`: as above, one a
/// photograph of LightField::photo_ids.
LightFieldSource SourceFromLightField(const LightField& light_field,
                                      std::vector<Eigen::Vector3d> eyes = {});

/// Where the photographs with these ids were taken. Throws Error, `name` of the light field in
/// front, when one has no pose.
std::vector<Eigen::Vector3d> EyesOfPhotos(const CalibResult& calib,
                                          const std::vector<std::string>& photo_ids,
                                          const std::string& name);

/// Throws Error, the source's name in front, when the counts, sizes or indices of one triangle do
/// not fit together, so that no later step reads out of bounds.
void CheckSourceTriangle(const LightFieldSource& source, int triangle);

}  // namespace lfm
