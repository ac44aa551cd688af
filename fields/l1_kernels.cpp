// SPDX-License-Identifier: BSD-3-Clause
// Iteratively reweighted least squares in correction form: y += (Q D Q^T)^-1 Q D r with D = 1 /
// max(|r|, eps). The correction is small, so float32 sums do; the small systems are solved in
// float64, as L D L^T, a lane each.
#include "fields/l1_kernels.h"

#include "core/lanes.h"

namespace lfm::kernels {
namespace {

constexpr int kBlock = 64, kPairs = kL1Terms * (kL1Terms + 1) / 2;

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

template <typename L, int kCount>
LFM_INLINE void SumShortRun(const float* factors, const float* lanes, int count, int run,
                            float* sums) {
  if (run == kCount) {
    SumRun<L, kCount>(factors, lanes, count, sums);
  } else if constexpr (kCount > 1) {
    SumShortRun<L, kCount - 1>(factors, lanes, count, run, sums);
  }
}

// One block of columns of the normal equations.
template <typename L>
LFM_INLINE void SumProducts(const L1Basis& basis, int begin, int count, const float* lanes,
                            float* sums) {
  const int pairs = basis.terms * (basis.terms + 1) / 2;
  const float* run = basis.products;
  int done = 0;
  for (; done + kL1Run <= pairs; done += kL1Run) {
    SumRun<L, kL1Run>(run + long{begin} * kL1Run, lanes, count, sums + done * L::kCount);
    run += long{basis.columns} * kL1Run;
  }
  const int rest = pairs - done;
  SumShortRun<L, kL1Run>(run + long{begin} * rest, lanes, count, rest, sums + done * L::kCount);
}

template <typename L>
LFM_INLINE void SumFunctions(const L1Basis& basis, int begin, int count, const float* lanes,
                             float* sums) {
  SumShortRun<L, kL1Terms>(basis.functions + long{begin} * basis.terms, lanes, count, basis.terms,
                           sums);
}

// The residuals of one block; their magnitudes are added to `error`.
template <typename L, int kTerms>
LFM_INLINE void ResidualsOf(const float* functions, const float* targets, const float* weights,
                            int count, float* residuals, typename L::Vector& error) {
  typename L::Vector weight[kTerms], sum = {};
  for (int k = 0; k < kTerms; ++k) weight[k] = Load<L>(weights + k * L::kCount);
  for (int j = 0; j < count; ++j) {
    typename L::Vector r = Load<L>(targets + j * L::kCount);
    for (int k = 0; k < kTerms; ++k) r -= functions[j * kTerms + k] * weight[k];
    Load<L>(residuals + j * L::kCount) = r;
    sum += r < 0 ? -r : r;
  }
  error += sum;
}

template <typename L, int kTerms = kL1Terms>
LFM_INLINE void Residuals(const L1Basis& basis, int begin, const float* targets,
                          const float* weights, int count, float* residuals,
                          typename L::Vector& error) {
  if (basis.terms == kTerms) {
    ResidualsOf<L, kTerms>(basis.functions + long{begin} * kTerms, targets, weights, count,
                           residuals, error);
  } else if constexpr (kTerms > 1) {
    Residuals<L, kTerms - 1>(basis, begin, targets, weights, count, residuals, error);
  }
}

// gram: the upper triangle, row by row; weights += gram^-1 slope. Directions in which the basis
// hardly reaches a column that counts are held back.
template <typename L>
LFM_INLINE void Step(const float* gram, const float* slope, int terms, float* weights) {
  constexpr int kLane = L::kCount;
  typename L::Wide factor[kL1Terms][kL1Terms], inverse[kL1Terms], x[kL1Terms];
  int pair = 0;
  for (int i = 0; i < terms; ++i) {
    for (int k = i; k < terms; ++k, ++pair) {
      factor[k][i] = __builtin_convertvector(Load<L>(gram + pair * kLane), typename L::Wide);
    }
    x[i] = __builtin_convertvector(Load<L>(slope + i * kLane), typename L::Wide);
  }
  for (int i = 0; i < terms; ++i) {
    const typename L::Wide least = factor[i][i] * 1e-6 + 1e-30;
    for (int l = 0; l < i; ++l) {
      const typename L::Wide scaled = factor[i][l] * inverse[l];
      factor[i][i] -= factor[i][l] * scaled;
      for (int k = i + 1; k < terms; ++k) factor[k][i] -= factor[k][l] * scaled;
      x[i] -= scaled * x[l];
    }
    inverse[i] = 1 / (factor[i][i] > least ? factor[i][i] : least);
  }
  for (int i = terms - 1; i >= 0; --i) {
    x[i] *= inverse[i];
    for (int k = i + 1; k < terms; ++k) x[i] -= factor[k][i] * inverse[i] * x[k];
    Load<L>(weights + i * kLane) += __builtin_convertvector(x[i], typename L::Vector);
  }
}

template <typename L>
LFM_INLINE void TotalError(const L1Basis& basis, const float* targets, const float* weights,
                           float* residuals, typename L::Vector& error) {
  error = typename L::Vector{};
  for (int begin = 0; begin < basis.columns; begin += kBlock) {
    const int count = begin + kBlock < basis.columns ? kBlock : basis.columns - begin;
    Residuals<L>(basis, begin, targets + long{begin} * L::kCount, weights, count, residuals, error);
  }
}

// The normal equations at `weights`, and the error there.
template <typename L>
LFM_INLINE void NormalEquations(const L1Basis& basis, const float* targets, const float* weights,
                                const typename L::Vector& least, float* residuals, float* gram,
                                float* slope, typename L::Vector& error) {
  constexpr int kLane = L::kCount;
  float factors[kBlock * kLane];
  const int pairs = basis.terms * (basis.terms + 1) / 2;
  for (int i = 0; i < pairs * kLane; ++i) gram[i] = 0;
  for (int i = 0; i < basis.terms * kLane; ++i) slope[i] = 0;
  error = typename L::Vector{};
  for (int begin = 0; begin < basis.columns; begin += kBlock) {
    const int count = begin + kBlock < basis.columns ? kBlock : basis.columns - begin;
    Residuals<L>(basis, begin, targets + long{begin} * kLane, weights, count, residuals, error);
    for (int j = 0; j < count; ++j) {
      typename L::Vector& r = Load<L>(residuals + j * kLane);
      const typename L::Vector magnitude = r < 0 ? -r : r;
      const typename L::Vector factor = 1 / (magnitude > least ? magnitude : least);
      Load<L>(factors + j * kLane) = factor;
      r *= factor;
    }
    SumProducts<L>(basis, begin, count, factors, gram);
    SumFunctions<L>(basis, begin, count, residuals, slope);
  }
}

template <typename L>
LFM_INLINE void Reweight(const L1Basis& basis, const L1Group& group) {
  constexpr int kLane = L::kCount;
  constexpr float kFinest = 1e-6F;  // of the targets: float32 knows no smaller residual
  float gram[kPairs * kLane], slope[kL1Terms * kLane], weights[kL1Terms * kLane];
  float residuals[kBlock * kLane];
  const int numbers = basis.terms * kLane;
  float* best_weights = group.weights;
  if (group.from_projection) {
    for (int i = 0; i < numbers; ++i) best_weights[i] = 0;
    for (int begin = 0; begin < basis.columns; begin += kBlock) {
      const int count = begin + kBlock < basis.columns ? kBlock : basis.columns - begin;
      SumFunctions<L>(basis, begin, count, group.targets + long{begin} * kLane, best_weights);
    }
  }
  for (int i = 0; i < numbers; ++i) weights[i] = best_weights[i];
  typename L::Vector best, error;
  TotalError<L>(basis, group.targets, weights, residuals, best);
  for (int iteration = 0; iteration <= group.iterations; ++iteration) {
    if (iteration == group.iterations) {
      TotalError<L>(basis, group.targets, weights, residuals, error);
    } else {
      const typename L::Vector part =
          best * (group.smoothing[iteration] / static_cast<float>(basis.columns));
      const typename L::Vector least = part > kFinest ? part : typename L::Vector{} + kFinest;
      NormalEquations<L>(basis, group.targets, weights, least, residuals, gram, slope, error);
    }
    const auto better = error < best;
    best = better ? error : best;
    for (int i = 0; i < numbers; i += kLane) {
      Load<L>(best_weights + i) = better ? Load<L>(weights + i) : Load<L>(best_weights + i);
    }
    if (iteration < group.iterations) Step<L>(gram, slope, basis.terms, weights);
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

#define LFM_COMPILE_KERNELS(NAME, TARGET, LANE)                                                 \
  TARGET void Reweight##NAME(const L1Basis& basis, const L1Group& group) {                      \
    Reweight<LANE>(basis, group);                                                               \
  }                                                                                             \
  TARGET void Error##NAME(const float* functions, int columns, int terms, const float* targets, \
                          const float* weights, double* errors) {                               \
    Error<LANE>(functions, columns, terms, targets, weights, errors);                           \
  }                                                                                             \
  constexpr L1Kernels k##NAME = {LANE::kCount, Reweight##NAME, Error##NAME};

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
