// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

#include "viewer/reference_renderer.h"

namespace lfm {

/// What the samples of one pixel gathered. A pixel of one sample keeps its code without a round
/// trip through linear light.
class PixelSum {
 public:
  void Add(const Eigen::Vector3f& coded);
  int hits() const { return hits_; }
  const Eigen::Vector3f& last() const { return last_; }  ///< coded
  Eigen::Vector3f Linear() const;                        ///< the sum of all hits

 private:
  int hits_ = 0;
  Eigen::Vector3f last_ = Eigen::Vector3f::Zero();
  Eigen::Vector3f linear_before_ = Eigen::Vector3f::Zero();  ///< of all but the last
};

/// Pictures of width x height with nothing in them.
Rendering EmptyRendering(int width, int height, const RenderOptions& options);

/// Throws Error unless samples_per_side lies in [1, 16] and the background in [0, 1].
void ValidateOptions(const RenderOptions& options);

/// Writes pixel (x, y) of all pictures, of samples_per_side^2 samples.
void StorePixel(const PixelSum& sum, const RenderOptions& options, int x, int y,
                Rendering& rendering);

}  // namespace lfm
