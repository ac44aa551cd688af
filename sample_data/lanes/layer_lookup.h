// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "sample_data/lanes/lane_math.h"

namespace lfm {

/// The tables of sample_data/layer_albedo.h. Null where no material of a scene needs them.
struct LayerTables {
  const float* dielectric = nullptr;       ///< an index, a roughness, a cosine
  const float* dielectric_mean = nullptr;  ///< an index, a roughness
  const float* fuzz = nullptr;             ///< a roughness, a cosine
  const float* fuzz_mean = nullptr;
};

inline constexpr int kLayerCosines = 24, kLayerIndices = 13, kLayerAlphas = 11,
                     kLayerFuzzAlphas = 24;
inline constexpr float kLayerIndexStep = 0.125f, kLayerFuzzSmoothest = 0.07f;

inline namespace LFM_LANE_SET {

/// The node at or below a place, and how far the place is towards the next.
template <typename F>
struct TablePlace {
  IntOf<F> index;
  F t;
};
template <typename F>
LFM_LANE TablePlace<F> LocateInTable(F x, int nodes) {
  const F held = Clamp(x, 0.0f, static_cast<float>(nodes - 1));
  const IntOf<F> whole = ToInt(held);
  const IntOf<F> index = Select(whole > nodes - 2, SplatInt<IntOf<F>>(nodes - 2), whole);
  return {index, held - ToFloat(index)};
}
/// Nodes are denser where albedos change fastest: near grazing.
template <typename F>
LFM_LANE TablePlace<F> LocateCosine(F cosine) {
  return LocateInTable(Sqrt(Max(cosine, 0.0f)) * (kLayerCosines - 1.0f), kLayerCosines);
}
template <typename F>
LFM_LANE F AlongTable(const float* table, IntOf<F> node, F t) {
  const F low = Gather(table, node);
  return low + t * (Gather(table, node + 1) - low);
}

template <typename F>
LFM_LANE F DielectricAlbedoAt(const LayerTables& tables, F ior, F alpha, F cosine) {
  const TablePlace<F> n = LocateInTable((ior - 1.0f) / kLayerIndexStep, kLayerIndices);
  const TablePlace<F> a = LocateInTable(alpha * (kLayerAlphas - 1.0f), kLayerAlphas);
  const TablePlace<F> c = LocateCosine(cosine);
  const IntOf<F> row = n.index * kLayerAlphas + a.index;
  const auto along = [&](int further) {
    return AlongTable<F>(tables.dielectric, (row + further) * kLayerCosines + c.index, c.t);
  };
  const F low = along(0), high = along(kLayerAlphas);
  const F left = low + a.t * (along(1) - low),
          right = high + a.t * (along(kLayerAlphas + 1) - high);
  return left + n.t * (right - left);
}
template <typename F>
LFM_LANE F DielectricAlbedoMean(const LayerTables& tables, F ior, F alpha) {
  const TablePlace<F> n = LocateInTable((ior - 1.0f) / kLayerIndexStep, kLayerIndices);
  const TablePlace<F> a = LocateInTable(alpha * (kLayerAlphas - 1.0f), kLayerAlphas);
  const IntOf<F> node = n.index * kLayerAlphas + a.index;
  const F low = AlongTable<F>(tables.dielectric_mean, node, a.t);
  return low + n.t * (AlongTable<F>(tables.dielectric_mean, node + kLayerAlphas, a.t) - low);
}

template <typename F>
LFM_LANE TablePlace<F> LocateFuzz(F alpha) {
  return LocateInTable(
      (alpha - kLayerFuzzSmoothest) / (1 - kLayerFuzzSmoothest) * (kLayerFuzzAlphas - 1.0f),
      kLayerFuzzAlphas);
}
template <typename F>
LFM_LANE F FuzzAlbedoAt(const LayerTables& tables, F alpha, F cosine) {
  const TablePlace<F> a = LocateFuzz(alpha), c = LocateCosine(cosine);
  const IntOf<F> node = a.index * kLayerCosines + c.index;
  const F low = AlongTable<F>(tables.fuzz, node, c.t);
  return low + a.t * (AlongTable<F>(tables.fuzz, node + kLayerCosines, c.t) - low);
}
template <typename F>
LFM_LANE F FuzzAlbedoMean(const LayerTables& tables, F alpha) {
  const TablePlace<F> a = LocateFuzz(alpha);
  return AlongTable<F>(tables.fuzz_mean, a.index, a.t);
}

}  // namespace LFM_LANE_SET
}  // namespace lfm
