// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "core/image.h"
#include "sample_data/sensor.h"
#include "sample_data/trouble.h"

namespace lfm {

/// A black RGB picture as a file of `format` holds it: 8-bit sRGB, 16-bit linear, float linear.
Image MakePicture(int width, int height, PhotoFormat format);
/// ".png", ".exr" or ".jpg".
std::string PictureEnding(PhotoFormat format);

/// Writes row `y` of a picture of MakePicture: linear RGB values (1: the sensor is full) through
/// the sensor, whose noise depends on (seed, index, y) and the place in the row only.
void ExposePictureRow(const Sensor& sensor, std::span<const float> row, uint64_t seed,
                      uint64_t index, int y, Image& picture);

}  // namespace lfm
