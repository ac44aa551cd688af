// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

#include "fields/field.h"
#include "fields/light_fit.h"

namespace lfm {

/// Points whose colour does not change with the light (Malzbender 2001, Section 3.1, LRGB): a fit
/// of the luminance, and a chroma each.
struct LuminanceFit {
  LightFit luminance;         ///< a row a point: of the brightest channel of the chroma
  std::vector<float> chroma;  ///< points x 3: 0 to 1, the largest of a point 1 (black points: 0)
};

/// Fits Y, the Rec. 709 luminance of the values in the fit's space (of one channel: that), and the
/// chroma sum_j C_j Y_j / sum_j Y_j^2 of each channel C, least squares as well. Throws Error as
/// FitLights does.
LuminanceFit FitLuminance(const Field& field, const LightFrame& frame, LightBasis basis,
                          FitSpace space);

/// Linear radiance under a light, `channels` x points, channel after channel as in Field.
std::vector<float> EvaluateLuminanceFit(const LuminanceFit& fit, int channels,
                                        const Eigen::Vector3d& to_light);

}  // namespace lfm
