// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "core/image.h"

namespace lfm {

/// A sensor that turns linear values (1 = full well) into electrons with noise. An infinite well
/// makes none.
struct Sensor {
  double full_well = 20000;  ///< electrons at 1; shot noise has the variance of the mean
  double read_noise = 5;     ///< electrons, standard deviation
};

/// Noise of the pixels: value + sqrt(value / full_well + (read_noise / full_well)^2) N(0, 1), each
/// value with its own random number that depends on (seed, picture, its place) only. The normal
/// distribution stands for Poisson's, whose mean and variance it shares. `values` must not be
/// below 0; those above 1 saturate later.
float NoisyValue(const Sensor& sensor, float value, double normal);
/// The variance of that noise.
double NoiseVariance(const Sensor& sensor, float value);

/// One picture row: `count` linear values to 8-bit sRGB, with noise.
void ExposeRow(const Sensor& sensor, const float* linear, int count, uint64_t seed,
               uint64_t picture, uint64_t row, uint8_t* out);

/// The same noise, kept as linear values, at most 1 (a full well); noise may take them below 0.
void ExposeRowLinear(const Sensor& sensor, const float* linear, int count, uint64_t seed,
                     uint64_t picture, uint64_t row, float* out);

/// The nearest 8-bit sRGB level of a linear value, clamped.
uint8_t EncodeSrgb8(float linear);

}  // namespace lfm
