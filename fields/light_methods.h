// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "core/pose.h"
#include "fields/field.h"
#include "fields/light_fit.h"
#include "fields/ptm_file.h"

namespace lfm {

/// One way to say what a field shows under a light that no picture was taken with.
struct LightMethod {
  std::string name;    ///< for people: "HSH 9"
  std::string family;  ///< methods that differ in one dial: a curve of bytes against error
  int64_t bytes = 0;   ///< what has to be kept to answer
  /// Linear radiance under parallel light of unit irradiance from a direction: a value a row of
  /// the field.
  std::function<std::vector<float>(const Eigen::Vector3d& to_light)> predict;
};

/// The light that is nearest in angle, the first of equals. Throws Error without any light.
int NearestLight(const std::vector<Eigen::Vector3d>& to_lights, const Eigen::Vector3d& to_light);

/// The training pictures themselves: that under the nearest light, and those around weighted
/// (InterpolateLights). They take a byte a value (8-bit pictures without compression).
/// Both refer to `train` later on.
LightMethod NearestPicture(const Field& train);
LightMethod InterpolatedPictures(const Field& train);

/// The classic fits of reflectance transformation imaging to the training pictures, in 8 bits a
/// coefficient (fields/quantized_fit.h).
struct ClassicFits {
  std::vector<QuantizedFit> fits;  ///< PTM LRGB (of colour alone), PTM, HSH 4, 9, 16
  std::vector<std::string> names;
};
/// In display space, as RTI viewers do it, in the frame given.
ClassicFits FitClassics(const Field& train, const LightFrame& frame);

/// Each fit as a method; refers to `fits` later on.
std::vector<LightMethod> ClassicMethods(const ClassicFits& fits, const Field& train);

}  // namespace lfm
