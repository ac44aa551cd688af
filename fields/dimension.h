// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "fields/function_rows.h"

namespace lfm {

/// The paper's shares of the energy: 3D plots (Figure 7), 2D plots (Figure 5) and N (Section 5.1).
inline constexpr double kFieldEnergyShare = 0.9995, kFlatlandEnergyShare = 0.999;

/// The eigenvalues of rows rows^T (squared singular values: energies), largest first, as many as
/// the smaller side has; exact in float64. The mean is not subtracted (Mahajan 2007, footnote 2).
/// A matrix without rows has none; a black one has zeros; any scale of float32 is kept apart from
/// overflow. Throws Error when a number is not finite.
std::vector<double> RowEnergies(RowsView rows);

/// How many of the energies, largest first, hold `share` (0 to 1) of their sum: the dimensionality
/// of Mahajan 2007, Section 3. Negative ones (rounding) count as 0. 0 where there is no energy.
int64_t TermsHolding(const std::vector<double>& energies, double share);

/// The same as a real number: the last term counts as much as is needed of it, so that slopes of
/// small dimensions do not jump. Within 1 below TermsHolding.
double FractionalTermsHolding(const std::vector<double>& energies, double share);

/// The dimensionality of a set of rows: TermsHolding of their energies. `expected`: what it may be
/// near; changes the time, not what is asked for. Throws Error as above.
int64_t DimensionOf(RowsView rows, double share, int64_t expected = 0);

}  // namespace lfm
