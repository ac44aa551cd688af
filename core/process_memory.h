// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace lfm {

/// Peak resident memory of this process so far, in MiB (0 where the system does not tell).
double PeakMemoryMib();

}  // namespace lfm
