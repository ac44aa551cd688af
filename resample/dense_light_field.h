// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "core/progress.h"
#include "resample/light_field.h"

namespace lfm {

/// The resampled matrix that the light field file avoids: F = P W of one triangle's corner.
/// `values[(sample * 3 + channel) * grid^2 + q]`, sRGB-coded [0, 1] (imputed values above), q as in
/// GridDirection. Zero for a triangle that nobody sees.
std::vector<float> DenseBlock(const LightField& light_field, int triangle, int corner);

/// Writes every block, triangle by triangle and corner by corner, as raw float32 behind a header
/// (docs/formats.md): the oracle of tests, and what compression ratios are counted against. Twelve
/// bytes x samples x grid^2 x 3 corners: gigabytes for a real object. Atomic.
void WriteDense(const LightField& light_field, const std::filesystem::path& file,
                Progress& progress);

/// Reads one block of such a file back, as a test does that takes the file for its oracle. Throws
/// Error when the file is not one, is truncated, or has no such block.
std::vector<float> ReadDenseBlock(const std::filesystem::path& file, int triangle, int corner);

}  // namespace lfm
