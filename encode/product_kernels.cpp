// SPDX-License-Identifier: BSD-3-Clause
// Loops over fixed vector types, so that accumulators stay in registers at every width. Each public
// function picks one of three compilations of the same always-inlined body. Explicit dispatch
// rather than target_clones: those resolve before the sanitizers are up.
#include "encode/product_kernels.h"

#include "core/lanes.h"

namespace lfm::kernels {
namespace {

template <typename Lane>
constexpr int kLanesOf16 = 16 * sizeof(float) / sizeof(Lane);

// kCount accumulator rows at once; element (r, i) of the left factor is p[r * row_step + i * step].
// Sums are flushed every kRun terms: shorter float32 sums round less.
template <typename Lane, int kLanes, int kCount>
LFM_INLINE void Panel(const float* p, long row_step, long step, int length, const float* z,
                      float* y) {
  constexpr int kLane = sizeof(Lane) / sizeof(float), kWidth = kLane * kLanes, kRun = 64;
  for (int i = 0; i < kCount * kWidth; ++i) y[i] = 0;
  for (int begin = 0; begin < length; begin += kRun) {
    const int end = begin + kRun < length ? begin + kRun : length;
    Lane sum[kCount][kLanes] = {};
    for (int i = begin; i < end; ++i) {
      Lane row[kLanes];
      for (int l = 0; l < kLanes; ++l) row[l] = At<Lane>(z + long{i} * kWidth + l * kLane);
      for (int r = 0; r < kCount; ++r) {
        const float factor = p[r * row_step + i * step];
        for (int l = 0; l < kLanes; ++l) sum[r][l] += factor * row[l];
      }
    }
    for (int r = 0; r < kCount; ++r) {
      for (int l = 0; l < kLanes; ++l) At<Lane>(y + long{r} * kWidth + l * kLane) += sum[r][l];
    }
  }
}

template <typename Lane, int kLanes, int kCount>
LFM_INLINE void Product(const float* p, int rows, long row_step, long step, int length,
                        const float* z, float* y) {
  constexpr int kWidth = sizeof(Lane) / sizeof(float) * kLanes;
  int r = 0;
  for (; r + kCount <= rows; r += kCount) {
    Panel<Lane, kLanes, kCount>(p + r * row_step, row_step, step, length, z, y + long{r} * kWidth);
  }
  for (; r < rows; ++r) {
    Panel<Lane, kLanes, 1>(p + r * row_step, row_step, step, length, z, y + long{r} * kWidth);
  }
}

template <typename Lane, int kLanes>
LFM_INLINE void ToViews(const WeightsByView& w, int views, int directions, int channels,
                        const float* x, float* z) {
  constexpr int kLane = sizeof(Lane) / sizeof(float);
  constexpr int kWidth = kLane * kLanes;
  for (int c = 0; c < channels; ++c) {
    const float* x_channel = x + long{c} * directions * kWidth;
    for (int v = 0; v < views; ++v) {
      Lane sum[kLanes] = {};
      for (int e = w.offsets[v]; e < w.offsets[v + 1]; ++e) {
        const float* row = x_channel + long{w.direction[e]} * kWidth;
        for (int l = 0; l < kLanes; ++l) sum[l] += w.weight[e] * At<Lane>(row + l * kLane);
      }
      float* out = z + (long{c} * views + v) * kWidth;
      for (int l = 0; l < kLanes; ++l) At<Lane>(out + l * kLane) = sum[l];
    }
  }
}

template <typename Lane, int kLanes>
LFM_INLINE void ToDirections(const uint16_t* view, const float* weight, int views, int directions,
                             int channels, const float* t, float* x) {
  constexpr int kLane = sizeof(Lane) / sizeof(float);
  constexpr int kWidth = kLane * kLanes;
  for (int c = 0; c < channels; ++c) {
    const float* t_channel = t + long{c} * views * kWidth;
    for (int q = 0; q < directions; ++q) {
      float* out = x + (long{c} * directions + q) * kWidth;
      for (int l = 0; l < kLanes; ++l) {
        Lane sum = At<Lane>(out + l * kLane);
        for (int k = 0; k < 3; ++k) {
          sum +=
              weight[3 * q + k] * At<Lane>(t_channel + long{view[3 * q + k]} * kWidth + l * kLane);
        }
        At<Lane>(out + l * kLane) = sum;
      }
    }
  }
}

LFM_INLINE Double4& Lane4(double* p) { return *reinterpret_cast<Double4*>(p); }

// Tiles of 4 x 8 sums stay in the registers of every instruction set; rows are widened a block at a
// time, so that no tile converts them again. Tiles below the diagonal are mirrored.
template <int kWidth>
LFM_INLINE void GramOf(const float* x, int rows, double* g) {
  constexpr int kBlock = 64, kTile = 4;
  double block[kBlock][kWidth];
  for (int i = 0; i < kWidth * kWidth; ++i) g[i] = 0;
  for (int begin = 0; begin < rows; begin += kBlock) {
    const int count = begin + kBlock < rows ? kBlock : rows - begin;
    for (int r = 0; r < count; ++r) {
      for (int j = 0; j < kWidth; ++j) block[r][j] = x[long{begin + r} * kWidth + j];
    }
    for (int first = 0; first < kWidth; first += kTile) {
      for (int column = first / 8 * 8; column < kWidth; column += 8) {
        Double4 low[kTile], high[kTile];
        for (int i = 0; i < kTile; ++i) {
          low[i] = Lane4(g + (first + i) * kWidth + column);
          high[i] = Lane4(g + (first + i) * kWidth + column + 4);
        }
        for (int r = 0; r < count; ++r) {
          const Double4 x_low = Lane4(block[r] + column), x_high = Lane4(block[r] + column + 4);
          for (int i = 0; i < kTile; ++i) {
            low[i] += block[r][first + i] * x_low;
            high[i] += block[r][first + i] * x_high;
          }
        }
        for (int i = 0; i < kTile; ++i) {
          Lane4(g + (first + i) * kWidth + column) = low[i];
          Lane4(g + (first + i) * kWidth + column + 4) = high[i];
        }
      }
    }
  }
  for (int i = 0; i < kWidth; ++i) {
    for (int j = 0; j < i / 8 * 8; ++j) g[i * kWidth + j] = g[j * kWidth + i];
  }
}

// `Wide` lanes of 16 floats only where the registers are as wide: split by the compiler, they go
// through memory (six times slower under AVX2).
template <typename Wide, int kCount>
LFM_INLINE void ProductOfWidth(const float* p, int rows, long row_step, long step, int length,
                               const float* z, int width, float* y) {
  if (width == 8) Product<Float8, 1, kCount>(p, rows, row_step, step, length, z, y);
  if (width == 16) Product<Wide, kLanesOf16<Wide>, kCount>(p, rows, row_step, step, length, z, y);
  if (width == 24) Product<Float8, 3, 4>(p, rows, row_step, step, length, z, y);
}

template <typename Wide>
LFM_INLINE void ToViewsOfWidth(const WeightsByView& w, int views, int directions, int channels,
                               const float* x, int width, float* z) {
  if (width == 8) ToViews<Float8, 1>(w, views, directions, channels, x, z);
  if (width == 16) ToViews<Wide, kLanesOf16<Wide>>(w, views, directions, channels, x, z);
  if (width == 24) ToViews<Float8, 3>(w, views, directions, channels, x, z);
}

template <typename Wide>
LFM_INLINE void ToDirectionsOfWidth(const uint16_t* view, const float* weight, int views,
                                    int directions, int channels, const float* t, int width,
                                    float* x) {
  if (width == 8) ToDirections<Float8, 1>(view, weight, views, directions, channels, t, x);
  if (width == 16)
    ToDirections<Wide, kLanesOf16<Wide>>(view, weight, views, directions, channels, t, x);
  if (width == 24) ToDirections<Float8, 3>(view, weight, views, directions, channels, t, x);
}

LFM_INLINE void GramOfWidth(const float* x, int rows, int width, double* g) {
  if (width == 8) GramOf<8>(x, rows, g);
  if (width == 16) GramOf<16>(x, rows, g);
  if (width == 24) GramOf<24>(x, rows, g);
}

// Eight rows at once, a lane each.
LFM_INLINE void DescendRows(const float* products, const float* g, const float* inverse, int terms,
                            int stride, int rows, int rounds, float* x) {
  constexpr int kRows = 8, kMost = 16;
  for (int first = 0; first < rows; first += kRows) {
    const int count = first + kRows < rows ? kRows : rows - first;
    Float8 target[kMost], value[kMost];
    for (int k = 0; k < terms; ++k) {
      target[k] = value[k] = Float8{};
      for (int r = 0; r < count; ++r) {
        target[k][r] = products[long{first + r} * stride + k];
        value[k][r] = x[long{first + r} * stride + k];
      }
    }
    for (int round = 0; round < rounds; ++round) {
      for (int k = 0; k < terms; ++k) {
        Float8 slope = target[k];
        for (int j = 0; j < terms; ++j) slope -= g[j * terms + k] * value[j];
        const Float8 next = value[k] + slope * inverse[k];
        value[k] = next > 0 ? next : Float8{};
      }
    }
    for (int k = 0; k < terms; ++k) {
      for (int r = 0; r < count; ++r) x[long{first + r} * stride + k] = value[k][r];
    }
  }
}

struct Kernels {
  void (*product)(const float*, int, long, long, int, const float*, int, float*);
  void (*to_views)(const WeightsByView&, int, int, int, const float*, int, float*);
  void (*to_directions)(const uint16_t*, const float*, int, int, int, const float*, int, float*);
  void (*gram)(const float*, int, int, double*);
  void (*descend)(const float*, const float*, const float*, int, int, int, int, float*);
};

#define LFM_COMPILE_KERNELS(NAME, TARGET, WIDE, COUNT)                                       \
  TARGET void Product##NAME(const float* p, int rows, long row_step, long step, int length,  \
                            const float* z, int width, float* y) {                           \
    ProductOfWidth<WIDE, COUNT>(p, rows, row_step, step, length, z, width, y);               \
  }                                                                                          \
  TARGET void ToViews##NAME(const WeightsByView& w, int views, int directions, int channels, \
                            const float* x, int width, float* z) {                           \
    ToViewsOfWidth<WIDE>(w, views, directions, channels, x, width, z);                       \
  }                                                                                          \
  TARGET void ToDirections##NAME(const uint16_t* view, const float* weight, int views,       \
                                 int directions, int channels, const float* t, int width,    \
                                 float* x) {                                                 \
    ToDirectionsOfWidth<WIDE>(view, weight, views, directions, channels, t, width, x);       \
  }                                                                                          \
  TARGET void Gram##NAME(const float* x, int rows, int width, double* g) {                   \
    GramOfWidth(x, rows, width, g);                                                          \
  }                                                                                          \
  TARGET void Descend##NAME(const float* products, const float* g, const float* inverse,     \
                            int terms, int stride, int rows, int rounds, float* x) {         \
    DescendRows(products, g, inverse, terms, stride, rows, rounds, x);                       \
  }                                                                                          \
  constexpr Kernels k##NAME = {Product##NAME, ToViews##NAME, ToDirections##NAME, Gram##NAME, \
                               Descend##NAME};

// Clang 14, which builds the fuzz targets, cannot ask for a level of the instruction set.
#if defined(__x86_64__) && !defined(__clang__)
#define LFM_KERNEL_LEVELS
#endif

LFM_COMPILE_KERNELS(Baseline, , Float8, 4)
#ifdef LFM_KERNEL_LEVELS
LFM_COMPILE_KERNELS(Avx2, __attribute__((target("arch=x86-64-v3"))), Float8, 4)
LFM_COMPILE_KERNELS(Avx512, __attribute__((target("arch=x86-64-v4"))), Float16, 8)
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

void Multiply(const float* p, int rows, int cols, const float* z, int width, float* y) {
  Best().product(p, rows, cols, 1, cols, z, width, y);
}

void MultiplyTransposed(const float* p, int rows, int cols, const float* y, int width, float* t) {
  Best().product(p, cols, 1, cols, rows, y, width, t);
}

void DirectionsToViews(const WeightsByView& weights, int views, int directions, int channels,
                       const float* x, int width, float* z) {
  Best().to_views(weights, views, directions, channels, x, width, z);
}

void AddViewsToDirections(const uint16_t* view, const float* weight, int views, int directions,
                          int channels, const float* t, int width, float* x) {
  Best().to_directions(view, weight, views, directions, channels, t, width, x);
}

void Gram(const float* x, int rows, int width, double* g) { Best().gram(x, rows, width, g); }

void DescendNonnegative(const float* products, const float* g, const float* inverse, int terms,
                        int stride, int rows, int rounds, float* x) {
  Best().descend(products, g, inverse, terms, stride, rows, rounds, x);
}

}  // namespace lfm::kernels
