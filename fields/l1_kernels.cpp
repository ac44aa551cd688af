// SPDX-License-Identifier: BSD-3-Clause
// Iteratively reweighted least squares in correction form: y += (Q D Q^T)^-1 Q D r with D = 1 /
// max(|r|, eps). The correction is small, so float32 sums do; the small systems are solved in
// float64, as L D L^T, a lane each.
#include "fields/l1_kernels.h"

#include "core/lanes.h"

namespace lfm::kernels {
namespace {

constexpr int kBlock = 64;

// What the loops below are compiled for. A template argument would lose the vector types'
// alignment; vectors are handed on by reference, since by value they would need an instruction set.
struct Lanes4 {
  static constexpr int kCount = 4;
  using Vector = Float4;
  using Wide = Double4;
};
struct Lanes8 {
  static constexpr int kCount = 8;
  using Vector = Float8;
  using Wide = double __attribute__((vector_size(64), aligned(8), may_alias));
};
struct Lanes16 {
  static constexpr int kCount = 16;
  using Vector = Float16;
  using Wide = double __attribute__((vector_size(128), aligned(8), may_alias));
};

template <typename L>
LFM_INLINE typename L::Vector& Load(float* p) {
  return *reinterpret_cast<typename L::Vector*>(p);
}
template <typename L>
LFM_INLINE const typename L::Vector& Load(const float* p) {
  return *reinterpret_cast<const typename L::Vector*>(p);
}

// sums[k] += sum_j factors[j][k] lanes[j]
template <typename L, int kCount>
LFM_INLINE void SumRun(const float* factors, const float* lanes, int count, float* sums) {
  typename L::Vector sum[kCount];
  for (int k = 0; k < kCount; ++k) sum[k] = Load<L>(sums + k * L::kCount);
  for (int j = 0; j < count; ++j) {
    const typename L::Vector value = Load<L>(lanes + j * L::kCount);
    for (int k = 0; k < kCount; ++k) sum[k] += factors[j * kCount + k] * value;
  }
  for (int k = 0; k < kCount; ++k) Load<L>(sums + k * L::kCount) = sum[k];
}

// One block of columns of the normal equations.
template <typename L, int kTerms>
LFM_INLINE void SumProducts(const L1Basis& basis, int begin, int count, const float* lanes,
                            float* sums) {
  constexpr int kPairs = kTerms * (kTerms + 1) / 2, kRest = kPairs % kL1Run;
  const float* run = basis.products;
  for (int done = 0; done + kL1Run <= kPairs; done += kL1Run) {
    SumRun<L, kL1Run>(run + long{begin} * kL1Run, lanes, count, sums + done * L::kCount);
    run += long{basis.columns} * kL1Run;
  }
  if constexpr (kRest > 0) {
    SumRun<L, kRest>(run + long{begin} * kRest, lanes, count, sums + (kPairs - kRest) * L::kCount);
  }
}

template <typename L, int kTerms>
LFM_INLINE void TotalError(const L1Basis& basis, const float* targets, const float* weights,
                           typename L::Vector& error) {
  typename L::Vector weight[kTerms];
  for (int k = 0; k < kTerms; ++k) weight[k] = Load<L>(weights + k * L::kCount);
  error = typename L::Vector{};
  for (int begin = 0; begin < basis.columns; begin += kBlock) {
    const int end = begin + kBlock < basis.columns ? begin + kBlock : basis.columns;
    typename L::Vector sum = {};
    for (int j = begin; j < end; ++j) {
      typename L::Vector r = Load<L>(targets + long{j} * L::kCount);
      for (int k = 0; k < kTerms; ++k) r -= basis.functions[long{j} * kTerms + k] * weight[k];
      sum += r > -r ? r : -r;
    }
    error += sum;
  }
}

// 1 / max(|r|, least) of one block, and r times that; the magnitudes are added to `error`.
template <typename L, int kTerms>
LFM_INLINE void Factors(const float* functions, const float* targets, const float* weights,
                        int count, const typename L::Vector& least, float* factors, float* signs,
                        typename L::Vector& error) {
  typename L::Vector weight[kTerms], sum = {};
  for (int k = 0; k < kTerms; ++k) weight[k] = Load<L>(weights + k * L::kCount);
  for (int j = 0; j < count; ++j) {
    typename L::Vector r = Load<L>(targets + j * L::kCount);
    for (int k = 0; k < kTerms; ++k) r -= functions[j * kTerms + k] * weight[k];
    const typename L::Vector magnitude = r > -r ? r : -r;
    sum += magnitude;
    const typename L::Vector factor = 1 / (magnitude > least ? magnitude : least);
    Load<L>(factors + j * L::kCount) = factor;
    Load<L>(signs + j * L::kCount) = r * factor;
  }
  error += sum;
}

// The normal equations at `weights`, and the error there.
template <typename L, int kTerms>
LFM_INLINE void NormalEquations(const L1Basis& basis, const float* targets, const float* weights,
                                const typename L::Vector& least, float* gram, float* slope,
                                typename L::Vector& error) {
  constexpr int kPairs = kTerms * (kTerms + 1) / 2;
  float factors[kBlock * L::kCount], signs[kBlock * L::kCount];
  for (int i = 0; i < kPairs * L::kCount; ++i) gram[i] = 0;
  for (int i = 0; i < kTerms * L::kCount; ++i) slope[i] = 0;
  error = typename L::Vector{};
  for (int begin = 0; begin < basis.columns; begin += kBlock) {
    const int count = begin + kBlock < basis.columns ? kBlock : basis.columns - begin;
    const float* functions = basis.functions + long{begin} * kTerms;
    Factors<L, kTerms>(functions, targets + long{begin} * L::kCount, weights, count, least, factors,
                       signs, error);
    SumProducts<L, kTerms>(basis, begin, count, factors, gram);
    SumRun<L, kTerms>(functions, signs, count, slope);
  }
}

// gram: the upper triangle, row by row; weights += gram^-1 slope. Directions in which the basis
// hardly reaches a column that counts are held back.
template <typename L, int kTerms>
LFM_INLINE void Step(const float* gram, const float* slope, float* weights) {
  typename L::Wide factor[kTerms][kTerms], inverse[kTerms], x[kTerms];
  int pair = 0;
  for (int i = 0; i < kTerms; ++i) {
    for (int k = i; k < kTerms; ++k, ++pair) {
      factor[k][i] = __builtin_convertvector(Load<L>(gram + pair * L::kCount), typename L::Wide);
    }
    x[i] = __builtin_convertvector(Load<L>(slope + i * L::kCount), typename L::Wide);
  }
  for (int i = 0; i < kTerms; ++i) {
    const typename L::Wide least = factor[i][i] * 1e-6 + 1e-30;
    for (int l = 0; l < i; ++l) {
      const typename L::Wide scaled = factor[i][l] * inverse[l];
      factor[i][i] -= factor[i][l] * scaled;
      for (int k = i + 1; k < kTerms; ++k) factor[k][i] -= factor[k][l] * scaled;
      x[i] -= scaled * x[l];
    }
    inverse[i] = 1 / (factor[i][i] > least ? factor[i][i] : least);
  }
  for (int i = kTerms - 1; i >= 0; --i) {
    x[i] *= inverse[i];
    for (int k = i + 1; k < kTerms; ++k) x[i] -= factor[k][i] * inverse[i] * x[k];
    Load<L>(weights + i * L::kCount) += __builtin_convertvector(x[i], typename L::Vector);
  }
}

template <typename L, int kTerms>
LFM_INLINE void Reweight(const L1Basis& basis, const L1Group& group) {
  constexpr float kFinest = 1e-6F;  // of the targets: float32 knows no smaller residual
  constexpr int kNumbers = kTerms * L::kCount;
  float gram[kTerms * (kTerms + 1) / 2 * L::kCount], slope[kNumbers], weights[kNumbers];
  float* best_weights = group.weights;
  if (group.from_projection) {
    for (int i = 0; i < kNumbers; ++i) best_weights[i] = 0;
    for (int begin = 0; begin < basis.columns; begin += kBlock) {
      const int count = begin + kBlock < basis.columns ? kBlock : basis.columns - begin;
      SumRun<L, kTerms>(basis.functions + long{begin} * kTerms,
                        group.targets + long{begin} * L::kCount, count, best_weights);
    }
  }
  for (int i = 0; i < kNumbers; ++i) weights[i] = best_weights[i];
  typename L::Vector best, error;
  TotalError<L, kTerms>(basis, group.targets, weights, best);
  for (int iteration = 0; iteration <= group.iterations; ++iteration) {
    if (iteration == group.iterations) {
      TotalError<L, kTerms>(basis, group.targets, weights, error);
    } else {
      const typename L::Vector part =
          best * (group.smoothing[iteration] / static_cast<float>(basis.columns));
      const typename L::Vector least = part > kFinest ? part : typename L::Vector{} + kFinest;
      NormalEquations<L, kTerms>(basis, group.targets, weights, least, gram, slope, error);
    }
    const auto better = error < best;
    best = better ? error : best;
    for (int i = 0; i < kNumbers; i += L::kCount) {
      Load<L>(best_weights + i) = better ? Load<L>(weights + i) : Load<L>(best_weights + i);
    }
    if (iteration < group.iterations) Step<L, kTerms>(gram, slope, weights);
  }
}

template <typename L>
LFM_INLINE void Error(const float* functions, int columns, int terms, const float* targets,
                      const float* weights, double* errors) {
  constexpr int kLane = L::kCount;
  typename L::Wide weight[kL1Terms], sum = {};
  for (int k = 0; k < terms; ++k) {
    weight[k] = __builtin_convertvector(Load<L>(weights + k * kLane), typename L::Wide);
  }
  for (int j = 0; j < columns; ++j) {
    typename L::Wide r =
        __builtin_convertvector(Load<L>(targets + long{j} * kLane), typename L::Wide);
    for (int k = 0; k < terms; ++k) {
      r -= static_cast<double>(functions[long{j} * terms + k]) * weight[k];
    }
    sum += r < 0 ? -r : r;
  }
  for (int l = 0; l < kLane; ++l) errors[l] = sum[l];
}

// A function a number of terms: in one of all, the compiler takes most loops for rarely used.
#define LFM_COMPILE_KERNELS(NAME, TARGET, LANES)                                                \
  template <int kTerms>                                                                         \
  TARGET void Reweight##NAME(const L1Basis& basis, const L1Group& group) {                      \
    Reweight<LANES, kTerms>(basis, group);                                                      \
  }                                                                                             \
  TARGET void Error##NAME(const float* functions, int columns, int terms, const float* targets, \
                          const float* weights, double* errors) {                               \
    Error<LANES>(functions, columns, terms, targets, weights, errors);                          \
  }                                                                                             \
  constexpr L1Kernels k##NAME = {                                                               \
      LANES::kCount,                                                                            \
      {Reweight##NAME<1>, Reweight##NAME<2>, Reweight##NAME<3>, Reweight##NAME<4>,              \
       Reweight##NAME<5>, Reweight##NAME<6>, Reweight##NAME<7>, Reweight##NAME<8>,              \
       Reweight##NAME<9>, Reweight##NAME<10>, Reweight##NAME<11>, Reweight##NAME<12>,           \
       Reweight##NAME<13>, Reweight##NAME<14>, Reweight##NAME<15>, Reweight##NAME<16>},         \
      Error##NAME};

// Clang 14, which builds the fuzz targets, cannot ask for a level of the instruction set.
#if defined(__x86_64__) && !defined(__clang__)
#define LFM_KERNEL_LEVELS
#endif

LFM_COMPILE_KERNELS(Baseline, , Lanes4)
#ifdef LFM_KERNEL_LEVELS
LFM_COMPILE_KERNELS(Avx2, __attribute__((target("arch=x86-64-v3"))), Lanes8)
LFM_COMPILE_KERNELS(Avx512, __attribute__((target("arch=x86-64-v4"))), Lanes16)
#endif

}  // namespace

bool HasL1Level(L1Level level) {
  switch (level) {
    case L1Level::kBaseline:
      return true;
#ifdef LFM_KERNEL_LEVELS
    case L1Level::kAvx2:
      return RunsLevel3();
    case L1Level::kAvx512:
      return RunsLevel4();
#endif
    default:
      return false;
  }
}

const L1Kernels& L1KernelsOf(L1Level level) {
#ifdef LFM_KERNEL_LEVELS
  if (level == L1Level::kAvx2) return kAvx2;
  if (level == L1Level::kAvx512) return kAvx512;
#else
  (void)level;
#endif
  return kBaseline;
}

const L1Kernels& BestL1Kernels() {
  static const L1Kernels& best = L1KernelsOf(HasL1Level(L1Level::kAvx512) ? L1Level::kAvx512
                                             : HasL1Level(L1Level::kAvx2) ? L1Level::kAvx2
                                                                          : L1Level::kBaseline);
  return best;
}

}  // namespace lfm::kernels
