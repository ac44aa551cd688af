// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

#include "fields/clustered_model.h"
#include "fields/field.h"

namespace lfm {

/// A linear basis over a field's directions, a function a row, sparse: of a light vector I it makes
/// the coefficients c_j = sum_i value_ji I_i (Haar wavelets over the lights, say; Yamada 2009,
/// Section 3.2). Entries of function j lie at first[j] to first[j + 1].
struct ColumnBasis {
  std::vector<int64_t> first;  ///< functions + 1; empty: columns are the directions themselves
  std::vector<uint32_t> direction;
  std::vector<float> value;

  bool IsIdentity() const { return first.empty(); }
  int64_t Functions() const { return first.empty() ? 0 : static_cast<int64_t>(first.size()) - 1; }
};

/// A field as a clustered model, with all that is needed to relight it: what a .lfr file holds
/// (fields/relightable_file.h).
///
/// Row channel * points + point of the model is one channel of one point, as in Field. With a
/// column basis the model's columns are its functions: R I = model (basis I), which is why an
/// orthonormal basis alone keeps R the product model * basis.
struct RelightableModel {
  std::string name;  ///< for people
  FieldColumns kind = FieldColumns::kLights;
  int64_t points = 0;
  int channels = 1;           ///< 1 or 3
  int width = 0, height = 0;  ///< of the picture whose pixels the points are; 0 x 0 for vertices
  std::vector<Eigen::Vector3f> positions;   ///< of vertices, mm, world frame; may be empty
  std::vector<Eigen::Vector3i> triangles;   ///< over the positions, corners counter-clockwise
  std::vector<Eigen::Vector3d> directions;  ///< unit, world frame
  ColumnBasis column_basis;
  ClusteredModel model;
};

/// The field's points and directions without a model.
RelightableModel MakeRelightable(const Field& field);

/// Throws Error when sizes do not fit together, a direction is not of unit length (to 1e-6), a
/// triangle has a corner that is not there, or CheckModel has something to say.
void CheckRelightable(const RelightableModel& relightable);

/// The coefficients of a light vector (one channel): `light` itself for an identity. Sums in
/// float64.
std::vector<float> ApplyColumnBasis(const ColumnBasis& basis, const std::vector<float>& light);

}  // namespace lfm
