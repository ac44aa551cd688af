// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <array>

namespace lfm {

/// Real spherical harmonics of bands 0 to 4, orthonormal over the sphere; index l (l + 1) + m.
inline constexpr int kHarmonics = 25;

/// All 25 at a unit direction.
std::array<float, kHarmonics> EvaluateHarmonics(const Eigen::Vector3f& direction);

/// The band l of an index.
inline constexpr std::array<int, kHarmonics> kHarmonicBand = {0, 1, 1, 1, 2, 2, 2, 2, 2, 3, 3, 3, 3,
                                                              3, 3, 3, 4, 4, 4, 4, 4, 4, 4, 4, 4};

}  // namespace lfm
