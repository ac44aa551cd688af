// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <vector>

#include "encode/map_transform.h"
#include "encode/model.h"
#include "encode/transport_stream.h"

namespace lfm::transport {

/// The cosine coefficients of one term of one vertex, scaled so that errors of both sides weigh the
/// same in their product: surface and view each have a norm of about sigma.
struct TermCoefficients {
  int sigma = 0;                         ///< exponent (SigmaOf)
  std::vector<Eigen::MatrixXf> surface;  ///< of each triangle of the ring (ToTriangle)
  std::array<Eigen::MatrixXf, 3> view;   ///< opponent colours
};
/// None where either map is zero.
std::optional<TermCoefficients> CoefficientsOfTerm(const LightFieldModel& model,
                                                   const MapTransform& transform, const Ring& ring,
                                                   int vertex, int term);

/// Those of a triangle's mean view without `predicted`, a colour.
std::array<Eigen::MatrixXf, 3> CoefficientsOfMean(const LightFieldModel& model,
                                                  const MapTransform& transform, int triangle,
                                                  const Eigen::Vector3f& predicted);

}  // namespace lfm::transport
