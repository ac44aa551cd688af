// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

namespace lfm {

/// One lens model that was tried, and how it explains corners kept out of its fit.
struct LensTrial {
  int terms = 0;
  double heldout_rms_px = 0;  ///< infinite when the lens folds over inside the picture
};

/// The same for a model of the platform ("as printed", "tags moved, bent", ...).
struct PlatformTrial {
  std::string model;
  double heldout_rms_px = 0;
};

/// "none", "k1", "k1 k2", "k1 k2 p1 p2", "k1 k2 p1 p2 k3", "k1 k2 p1 p2 k3 k4 k5 k6": what so many
/// lens terms are.
std::string LensModelName(int terms);
/// Whether so many terms are one of these models.
bool IsLensModel(int terms);

}  // namespace lfm
