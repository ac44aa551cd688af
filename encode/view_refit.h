// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

#include "encode/light_field_source.h"
#include "encode/model.h"

namespace lfm {

/// The view maps of one vertex before they are quantised, and what their errors cost.
struct FittedViews {
  std::vector<std::vector<float>> views;  ///< a term each: 3 q + channel
  Eigen::MatrixXd gram;                   ///< products of the terms' surface maps
  std::vector<float> direction_weights;   ///< N; as in the fit of the terms
};

/// The view maps that fit the light field best beside the model's mean view and surface maps as
/// they are now, quantised, shared or in blocks: the exact least squares fit, all terms together,
///
///   min |F - sum_k u_k v_k^T|^2 + 1e-3 sum_k |u_k|^2 |v_k - h_k|^2,
///
/// h being the model's present view maps (terms whose surface maps have become alike stay apart).
/// With mean_in_terms the present maps are returned: a fit would make them negative. One a vertex.
/// Model and source must be of one mesh.
std::vector<FittedViews> RefitViews(const LightFieldSource& source, const LightFieldModel& model,
                                    double guessed_weight);

/// Quantises each vertex's view maps, in the grids that the model has for them, with ranges of
/// their own and writes them to its tiles, which no other vertex shares.
void WriteViews(const std::vector<FittedViews>& views, LightFieldModel& model);

/// The ranges of view maps (scale and bias of each term) with which the codes in the model's pages
/// come nearest to the fitted maps, in the light field: least squares over all terms of a vertex.
/// A scale below zero becomes zero. Returns the model.
LightFieldModel FitViewRanges(LightFieldModel model, const std::vector<FittedViews>& views);

}  // namespace lfm
