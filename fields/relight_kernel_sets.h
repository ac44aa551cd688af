// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "fields/relight_kernels.h"

// Clang 14, which builds the fuzz targets, cannot ask for a level of the instruction set.
#if defined(__x86_64__) && !defined(__clang__)
#define LFM_RELIGHT_LEVELS
#endif

namespace lfm::kernels {

/// The kernels of one instruction set.
struct RelightKernels {
  void (*weigh)(const GroupWeights&, int64_t, int64_t, const float*, int, float*);
  void (*add)(const GroupResiduals&, int64_t, int64_t, const float*, int, float*);
  void (*half_products)(const uint16_t*, int64_t, int, const float*, float*);
};

#ifdef LFM_RELIGHT_LEVELS
extern const RelightKernels kRelightAvx2, kRelightAvx512;
#endif

}  // namespace lfm::kernels
