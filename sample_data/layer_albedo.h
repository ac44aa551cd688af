// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

#include "sample_data/lanes/layer_lookup.h"
#include "sample_data/material.h"

namespace lfm {

/// Directional albedos of layers that lie over a diffuse base, tabulated, so that the base gets
/// exactly what the layer leaves. With E(c) the share that the layer reflects at cosine c and
/// E_mean = 2 int_0^1 E(c) c dc, a base of albedo rho reflects
///
///   rho (1 - E(co)) (1 - E(ci)) / (pi (1 - E_mean)),
///
/// which is reciprocal and gives layer + base a total of E + rho (1 - E): 1 for a white base
/// (Kelemen and Szirmay-Kalos 2001, section 3).

/// The GGX dielectric (exact Fresnel, single scattering): index in [1, 2.5], roughness in [0, 1],
/// arguments outside are clamped. Bilinear in roughness and cosine, linear in the index; within
/// 0.01 of the integral.
class DielectricAlbedo {
 public:
  DielectricAlbedo();
  float At(float ior, float alpha, float cosine) const;
  float Mean(float ior, float alpha) const;
  const std::vector<float>& table() const { return table_; }  ///< LayerTables::dielectric
  const std::vector<float>& mean() const { return mean_; }

 private:
  std::vector<float> table_, mean_;
};

/// Albedo of the fibres of sample_data/lanes/fuzz.h for a white sheen; roughness in [0.07, 1].
class FuzzAlbedo {
 public:
  FuzzAlbedo();
  float At(float alpha, float cosine) const;
  float Mean(float alpha) const;
  const std::vector<float>& table() const { return table_; }  ///< LayerTables::fuzz
  const std::vector<float>& mean() const { return mean_; }

 private:
  std::vector<float> table_, mean_;
};

/// The tables, made on first use (about 0.1 s, the same everywhere) and never changed.
const DielectricAlbedo& DielectricAlbedoTable();
const FuzzAlbedo& FuzzAlbedoTable();
/// What a kind of material looks up, for sample_data/lanes; the tables of other kinds are null.
LayerTables LayerTablesFor(MaterialKind kind);

}  // namespace lfm
