// SPDX-License-Identifier: BSD-3-Clause
#include "fields/relightable_model.h"

#include <cmath>
#include <string>

#include "core/error.h"

namespace lfm {
namespace {

[[noreturn]] void Fail(const std::string& what) { throw Error("relightable model: " + what); }

void CheckShape(const RelightableModel& r) {
  if (r.kind != FieldColumns::kLights && r.kind != FieldColumns::kCubeTexels &&
      r.kind != FieldColumns::kViews) {
    Fail("its columns are of no known kind");
  }
  if (r.channels != 1 && r.channels != 3) {
    Fail(std::to_string(r.channels) + " channels; it must be 1 or 3");
  }
  if (r.points < 1 || r.points > (int64_t{1} << 36)) {
    Fail(std::to_string(r.points) + " points; it must be 1 to 2^36");
  }
  if (r.width < 0 || r.height < 0 || r.width > 65536 || r.height > 65536 ||
      (r.width == 0) != (r.height == 0) ||
      (r.width > 0 && int64_t{r.width} * r.height != r.points)) {
    Fail("a picture of " + std::to_string(r.width) + " x " + std::to_string(r.height) +
         " pixels for " + std::to_string(r.points) + " points");
  }
  if (r.model.rows != r.points * r.channels) Fail("its rows are not its points in every channel");
}

void CheckGeometry(const RelightableModel& r) {
  if (!r.positions.empty() && static_cast<int64_t>(r.positions.size()) != r.points) {
    Fail("as many positions as points, or none");
  }
  for (const Eigen::Vector3f& position : r.positions) {
    if (!position.allFinite()) Fail("a position is not finite");
  }
  const auto vertices = static_cast<int64_t>(r.positions.size());
  for (const Eigen::Vector3i& triangle : r.triangles) {
    if (triangle.minCoeff() < 0 || triangle.maxCoeff() >= vertices) {
      Fail("a triangle has a corner that is not there");
    }
  }
}

void CheckBasis(const ColumnBasis& basis, int columns, size_t directions) {
  if (basis.Functions() != columns) Fail("its column basis has not a function for every column");
  if (basis.direction.size() != basis.value.size() || basis.first.front() != 0 ||
      basis.first.back() != static_cast<int64_t>(basis.value.size())) {
    Fail("the tables of its column basis do not fit together");
  }
  for (size_t j = 0; j + 1 < basis.first.size(); ++j) {
    if (basis.first[j + 1] < basis.first[j]) Fail("its column basis goes backwards");
  }
  for (size_t i = 0; i < basis.value.size(); ++i) {
    if (basis.direction[i] >= directions || !std::isfinite(basis.value[i])) {
      Fail("its column basis has an entry beyond its directions, or not finite");
    }
  }
}

}  // namespace

RelightableModel MakeRelightable(const Field& field) {
  RelightableModel result;
  result.name = field.name;
  result.kind = field.kind;
  result.points = field.points;
  result.channels = field.channels;
  result.width = field.width;
  result.height = field.height;
  result.positions = field.positions;
  result.directions = field.directions;
  return result;
}

void CheckRelightable(const RelightableModel& r) {
  CheckShape(r);
  CheckGeometry(r);
  if (r.directions.empty()) Fail("no directions");
  for (size_t i = 0; i < r.directions.size(); ++i) {
    if (!(std::abs(r.directions[i].norm() - 1) <= 1e-6)) {
      Fail("direction " + std::to_string(i) + " is not of unit length");
    }
  }
  if (!r.column_basis.IsIdentity()) {
    CheckBasis(r.column_basis, r.model.columns, r.directions.size());
  } else if (r.model.columns != static_cast<int64_t>(r.directions.size())) {
    Fail(std::to_string(r.directions.size()) + " directions for " +
         std::to_string(r.model.columns) + " columns");
  }
  CheckModel(r.model);
}

std::vector<float> ApplyColumnBasis(const ColumnBasis& basis, const std::vector<float>& light) {
  if (basis.IsIdentity()) return light;
  std::vector<float> coefficients(static_cast<size_t>(basis.Functions()));
  for (size_t j = 0; j < coefficients.size(); ++j) {
    double sum = 0;
    for (int64_t i = basis.first[j]; i < basis.first[j + 1]; ++i) {
      sum += double{basis.value[i]} * light.at(basis.direction[i]);
    }
    coefficients[j] = static_cast<float>(sum);
  }
  return coefficients;
}

}  // namespace lfm
