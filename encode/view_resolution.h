// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

namespace lfm {

/// The grids that a view map may have, finest first: that of the model, half of it, and a quarter;
/// none below 4, and no half of an odd one.
std::vector<int> ViewGridLevels(int grid);

/// Changes of a view map's grid. Both grids have texels on the border of the square, and `values`
/// are 3 q + channel, q rows from the top. Equal grids give the same values.
class ViewResampler {
 public:
  ViewResampler(int from, int to);
  /// To a finer grid: interpolated as EvaluateModel does. To a coarser one: what comes nearest when
  /// interpolated back, by least squares over the finer grid's texels.
  std::vector<float> operator()(std::span<const float> values) const;

 private:
  int from_, to_;
  Eigen::MatrixXf along_side_;  ///< to x from
};

/// The one between these grids, made once a thread.
const ViewResampler& ResamplerBetween(int from, int to);

}  // namespace lfm
