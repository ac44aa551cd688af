// SPDX-License-Identifier: BSD-3-Clause
// A product of packed panels (Goto and van de Geijn 2008, "Anatomy of high-performance matrix
// multiplication"): strips of a and b are copied so that the innermost loop reads one line after
// the other and keeps a block of c in registers. Each public function picks one of three
// compilations of the same always-inlined body.
#include "fields/matrix_kernels.h"

#include "core/lanes.h"

namespace lfm::kernels {
namespace {

using Double2 = double __attribute__((vector_size(16), aligned(8), may_alias));
using Double8 = double __attribute__((vector_size(64), aligned(8), may_alias));

constexpr int kRun = 128;  // depth of a strip: its panel of b stays in the first cache

template <typename Lane, typename Number>
LFM_INLINE Lane& LaneAt(Number* p) {
  return *reinterpret_cast<Lane*>(p);
}
template <typename Lane, typename Number>
LFM_INLINE const Lane& LaneAt(const Number* p) {
  return *reinterpret_cast<const Lane*>(p);
}

// Panels of kWidth lines each: out[panel][k][line]; element (line, k) of the factor is
// from[line * line_step + k * step]. Lines beyond the last are zero.
template <int kWidth, typename From, typename Number>
LFM_INLINE void Pack(const From* from, int64_t line_step, int64_t step, int lines, int depth,
                     Number* out) {
  for (int first = 0; first < lines; first += kWidth, out += kWidth * depth) {
    const int count = lines - first < kWidth ? lines - first : kWidth;
    const From* panel = from + first * line_step;
    if (count < kWidth) {
      for (int i = 0; i < kWidth * depth; ++i) out[i] = 0;
    }
    if (line_step == 1 && count == kWidth) {
      for (int k = 0; k < depth; ++k) {
        for (int i = 0; i < kWidth; ++i) out[k * kWidth + i] = Number(panel[k * step + i]);
      }
    } else {
      for (int i = 0; i < count; ++i) {
        const From* line = panel + i * line_step;
        for (int k = 0; k < depth; ++k) out[k * kWidth + i] = Number(line[k * step]);
      }
    }
  }
}

// kRows x (kLanes lanes) of c += the product of two panels.
template <typename Lane, int kRows, int kLanes, typename Number>
LFM_INLINE void Block(const Number* a, const Number* b, int depth, int rows, int columns, Number* c,
                      int64_t c_step) {
  constexpr int kLane = sizeof(Lane) / sizeof(Number), kColumns = kLane * kLanes;
  Lane sum[kRows][kLanes] = {};
  for (int k = 0; k < depth; ++k, a += kRows, b += kColumns) {
    Lane line[kLanes];
    for (int l = 0; l < kLanes; ++l) line[l] = LaneAt<Lane>(b + l * kLane);
    for (int r = 0; r < kRows; ++r) {
      for (int l = 0; l < kLanes; ++l) sum[r][l] += a[r] * line[l];
    }
  }
  if (rows >= kRows && columns >= kColumns) {
    for (int r = 0; r < kRows; ++r) {
      for (int l = 0; l < kLanes; ++l) LaneAt<Lane>(c + r * c_step + l * kLane) += sum[r][l];
    }
    return;
  }
  Number rest[kRows * kColumns];
  for (int r = 0; r < kRows; ++r) {
    for (int l = 0; l < kLanes; ++l) LaneAt<Lane>(rest + r * kColumns + l * kLane) = sum[r][l];
  }
  for (int r = 0; r < kRows && r < rows; ++r) {
    for (int j = 0; j < kColumns && j < columns; ++j) c[r * c_step + j] += rest[r * kColumns + j];
  }
}

template <typename Lane, int kRows, int kLanes, typename From, typename Number>
LFM_INLINE void Tile(Factor<From> a, Factor<float> b, int rows, int64_t depth, int columns,
                     Number* c, int64_t c_step, Number* workspace) {
  constexpr int kColumns = sizeof(Lane) / sizeof(Number) * kLanes;
  Number* packed_a = workspace;
  Number* packed_b = workspace + kProductWorkspace / 2;
  for (int64_t first = 0; first < depth; first += kRun) {
    const int run = static_cast<int>(depth - first < kRun ? depth - first : kRun);
    Pack<kRows>(a.values + first * a.column_step, a.row_step, a.column_step, rows, run, packed_a);
    Pack<kColumns>(b.values + first * b.row_step, b.column_step, b.row_step, columns, run,
                   packed_b);
    for (int j = 0; j < columns; j += kColumns) {
      for (int i = 0; i < rows; i += kRows) {
        Block<Lane, kRows, kLanes>(packed_a + int64_t{i} * run, packed_b + int64_t{j} * run, run,
                                   rows - i, columns - j, c + i * c_step + j, c_step);
      }
    }
  }
}

struct Kernels {
  void (*single)(Factor<float>, Factor<float>, int, int64_t, int, float*, int64_t, float*);
  void (*wide)(Factor<float>, Factor<float>, int, int64_t, int, double*, int64_t, double*);
  void (*mixed)(Factor<double>, Factor<float>, int, int64_t, int, double*, int64_t, double*);
};

#define LFM_COMPILE_KERNELS(NAME, TARGET, SINGLE, WIDE, ROWS, LANES)                               \
  TARGET void Single##NAME(Factor<float> a, Factor<float> b, int rows, int64_t depth, int columns, \
                           float* c, int64_t c_step, float* workspace) {                           \
    Tile<SINGLE, ROWS, LANES>(a, b, rows, depth, columns, c, c_step, workspace);                   \
  }                                                                                                \
  TARGET void Wide##NAME(Factor<float> a, Factor<float> b, int rows, int64_t depth, int columns,   \
                         double* c, int64_t c_step, double* workspace) {                           \
    Tile<WIDE, ROWS, LANES>(a, b, rows, depth, columns, c, c_step, workspace);                     \
  }                                                                                                \
  TARGET void Mixed##NAME(Factor<double> a, Factor<float> b, int rows, int64_t depth, int columns, \
                          double* c, int64_t c_step, double* workspace) {                          \
    Tile<WIDE, ROWS, LANES>(a, b, rows, depth, columns, c, c_step, workspace);                     \
  }                                                                                                \
  constexpr Kernels k##NAME = {Single##NAME, Wide##NAME, Mixed##NAME};

// Clang 14, which builds the fuzz targets, cannot ask for a level of the instruction set.
#if defined(__x86_64__) && !defined(__clang__)
#define LFM_KERNEL_LEVELS
#endif

LFM_COMPILE_KERNELS(Baseline, , Float4, Double2, 4, 2)
#ifdef LFM_KERNEL_LEVELS
LFM_COMPILE_KERNELS(Avx2, __attribute__((target("arch=x86-64-v3"))), Float8, Double4, 4, 3)
LFM_COMPILE_KERNELS(Avx512, __attribute__((target("arch=x86-64-v4"))), Float16, Double8, 8, 3)
#endif

const Kernels& Best() {
#ifdef LFM_KERNEL_LEVELS
  static const Kernels& best = kernels::RunsLevel4()   ? kAvx512
                               : kernels::RunsLevel3() ? kAvx2
                                                       : kBaseline;
  return best;
#else
  return kBaseline;
#endif
}

}  // namespace

void AddProduct(Factor<float> a, Factor<float> b, int rows, int64_t depth, int columns, float* c,
                int64_t c_step, float* workspace) {
  Best().single(a, b, rows, depth, columns, c, c_step, workspace);
}

void AddProduct(Factor<float> a, Factor<float> b, int rows, int64_t depth, int columns, double* c,
                int64_t c_step, double* workspace) {
  Best().wide(a, b, rows, depth, columns, c, c_step, workspace);
}

void AddProduct(Factor<double> a, Factor<float> b, int rows, int64_t depth, int columns, double* c,
                int64_t c_step, double* workspace) {
  Best().mixed(a, b, rows, depth, columns, c, c_step, workspace);
}

}  // namespace lfm::kernels
