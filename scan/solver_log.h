// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace lfm {

/// Keeps the log of the solver's library (glog) from standard error, which belongs to our own
/// one-line errors: `ceres::SILENT` leaves the reasons for which it gives up. Any number of times,
/// from any thread.
void SilenceSolverLog();

}  // namespace lfm
