// SPDX-License-Identifier: BSD-3-Clause
#include "scan/gray_kernel_body.h"

namespace lfm::kernels {

extern const GrayKernels kBaselineGray = kOfTheseInstructions;

}  // namespace lfm::kernels
