// SPDX-License-Identifier: BSD-3-Clause
// Compiled once for each instruction set (CMakeLists.txt); see sample_data/lanes/lanes.h.
#include "sample_data/lanes/path_kernels_body.h"

namespace lfm {

#define LFM_STRING_OF(x) #x
#define LFM_STRING(x) LFM_STRING_OF(x)
#define LFM_JOIN_OF(a, b) a##b
#define LFM_JOIN(a, b) LFM_JOIN_OF(a, b)

// kernels_of_lanes_baseline and so on.
extern const PathKernels LFM_JOIN(kernels_of_, LFM_LANE_SET);
const PathKernels LFM_JOIN(kernels_of_, LFM_LANE_SET) = {LFM_STRING(LFM_LANE_SET), FetchPack,
                                                         ShadePack};

}  // namespace lfm
