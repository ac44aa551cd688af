// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#define LFM_INLINE [[gnu::always_inline]] inline

/// The vectors that the kernels are written in. Only for files that compile one always-inlined body
/// for several instruction sets: nothing here may become a function of its own, which the linker
/// would take from whichever it finds.
namespace lfm::kernels {

// Element alignment: the arrays are ordinary arrays.
using Float4 = float __attribute__((vector_size(16), aligned(4), may_alias));
using Float8 = float __attribute__((vector_size(32), aligned(4), may_alias));
using Float16 = float __attribute__((vector_size(64), aligned(4), may_alias));
using Double4 = double __attribute__((vector_size(32), aligned(8), may_alias));
using Int8 = int32_t __attribute__((vector_size(32), aligned(4), may_alias));
using Byte8 = uint8_t __attribute__((vector_size(8), aligned(1), may_alias));

#if defined(__x86_64__)
/// Whether this machine runs code for x86-64-v3, and v4: asked by features, for compilers that do
/// not know the levels' names. What no machine with these lacks is not asked for.
LFM_INLINE bool RunsLevel3() {
  return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma") &&
         __builtin_cpu_supports("bmi2");
}
LFM_INLINE bool RunsLevel4() {
  return RunsLevel3() && __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512bw") &&
         __builtin_cpu_supports("avx512cd") && __builtin_cpu_supports("avx512dq") &&
         __builtin_cpu_supports("avx512vl");
}
#endif

template <typename Lane>
LFM_INLINE Lane& At(float* p) {
  return *reinterpret_cast<Lane*>(p);
}
template <typename Lane>
LFM_INLINE const Lane& At(const float* p) {
  return *reinterpret_cast<const Lane*>(p);
}

}  // namespace lfm::kernels
