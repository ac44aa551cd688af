// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

namespace lfm {

/// The hemispherical harmonics of the first `bands` bands (Gautron 2004, Equations 4 to 6), bands^2
/// functions, orthonormal over the hemisphere z >= 0: with theta, phi the angles of `local`,
/// P the associated Legendre functions shifted to [0, 1] and N their norms,
///
///   H_lm = sqrt(2) N_lm cos(m phi) P_lm(2 cos theta - 1)     m > 0
///        = N_l0 P_l0(2 cos theta - 1)                        m = 0
///        = sqrt(2) N_l|m| sin(|m| phi) P_l|m|(...)           m < 0
///
/// H_lm stands at l^2 + l - m, and functions of |m| = 2 have the minus sign: order and signs of
/// .rti files (fields/rti_file.h). `local` is a unit vector with z >= 0; at the pole, where phi
/// means nothing, functions of m != 0 are zero; at the horizon all are finite, and so are zero for
/// m != 0 too. 1 to 4 bands, else throws Error (kSystem).
Eigen::VectorXd HemisphericalHarmonics(int bands, const Eigen::Vector3d& local);

}  // namespace lfm
