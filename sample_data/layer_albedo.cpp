// SPDX-License-Identifier: BSD-3-Clause
#include "sample_data/layer_albedo.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "sample_data/lanes/fresnel.h"
#include "sample_data/lanes/fuzz.h"
#include "sample_data/lanes/microfacet.h"

namespace lfm {
namespace {

using V = Vec<float>;

constexpr int kCosines = kLayerCosines, kIndices = kLayerIndices, kAlphas = kLayerAlphas,
              kFuzzAlphas = kLayerFuzzAlphas;
constexpr float kPi = kLanePi;

// Nodes as LocateCosine has them.
float NodeCosine(int j) {
  const float x = static_cast<float>(j) / (kCosines - 1);
  return x * x;
}

// 2 int E(c) c dc of a row, linear in sqrt(c) between the nodes, exactly: with c = x^2 the
// integral is 4 int E x^3 dx.
float MeanOfRow(const float* row) {
  double sum = 0;
  for (int j = 0; j + 1 < kCosines; ++j) {
    const double a = static_cast<double>(j) / (kCosines - 1);
    const double b = static_cast<double>(j + 1) / (kCosines - 1);
    const double slope = (row[j + 1] - row[j]) / (b - a), base = row[j] - slope * a;
    sum +=
        base * (std::pow(b, 4) - std::pow(a, 4)) + slope * 0.8 * (std::pow(b, 5) - std::pow(a, 5));
  }
  return static_cast<float>(sum);
}

float RoughDielectric(float ior, float alpha, float cosine) {
  const float c = std::max(cosine, 1e-3f);
  const V o = {std::sqrt(1 - c * c), 0, c};
  const float so = GgxStretch(o, alpha, alpha);
  constexpr int kSamples = 512;
  double sum = 0;
  for (int s = 0; s < kSamples; ++s) {
    const float u1 = (static_cast<float>(s) + 0.5f) / kSamples;
    const double golden = s * 0.6180339887498949;
    const V h =
        SampleGgxNormal(o, alpha, alpha, u1, static_cast<float>(golden - std::floor(golden)));
    const float oh = Dot(o, h);
    const V i = 2 * oh * h - o;
    if (i.z <= 0) continue;
    const float si = GgxStretch(i, alpha, alpha);
    sum += DielectricFresnel(oh, ior) * i.z * (o.z + so) / (so * i.z + si * o.z);
  }
  return static_cast<float>(sum / kSamples);
}

float WhiteFuzz(float alpha, float cosine) {
  const float c = std::max(cosine, 1e-3f);
  const V o = {std::sqrt(1 - c * c), 0, c};
  constexpr int kSteps = 32;
  double sum = 0;
  for (int a = 0; a < kSteps; ++a) {
    // Squared nodes: fibres reflect most near the horizon.
    const float x = (static_cast<float>(a) + 0.5f) / kSteps, z = x * x;
    for (int b = 0; b < kSteps; ++b) {
      const float phi = kPi * (static_cast<float>(b) + 0.5f) / kSteps;
      const float s = std::sqrt(1 - z * z);
      sum += FuzzReflection(o, V{s * std::cos(phi), s * std::sin(phi), z}, alpha) * z * 2 * x;
    }
  }
  return static_cast<float>(sum * 2 * kPi / (kSteps * kSteps));
}

float FuzzNodeAlpha(int a) {
  return kFuzzSmoothest + (1 - kFuzzSmoothest) * static_cast<float>(a) / (kFuzzAlphas - 1);
}
}  // namespace

DielectricAlbedo::DielectricAlbedo() {
  for (int n = 0; n < kIndices; ++n) {
    const float ior = 1 + kLayerIndexStep * static_cast<float>(n);
    for (int a = 0; a < kAlphas; ++a) {
      const float alpha = static_cast<float>(a) / (kAlphas - 1);
      const size_t row = table_.size();
      for (int j = 0; j < kCosines; ++j) {
        const float c = NodeCosine(j);
        table_.push_back(a == 0 ? DielectricFresnel(c, ior) : RoughDielectric(ior, alpha, c));
      }
      mean_.push_back(MeanOfRow(&table_[row]));
    }
  }
}

float DielectricAlbedo::At(float ior, float alpha, float cosine) const {
  return DielectricAlbedoAt(LayerTables{table_.data(), mean_.data()}, ior, alpha, cosine);
}

float DielectricAlbedo::Mean(float ior, float alpha) const {
  return DielectricAlbedoMean(LayerTables{table_.data(), mean_.data()}, ior, alpha);
}

FuzzAlbedo::FuzzAlbedo() {
  for (int a = 0; a < kFuzzAlphas; ++a) {
    const size_t row = table_.size();
    for (int j = 0; j < kCosines; ++j) {
      table_.push_back(std::min(1.0f, WhiteFuzz(FuzzNodeAlpha(a), NodeCosine(j))));
    }
    mean_.push_back(MeanOfRow(&table_[row]));
  }
}

float FuzzAlbedo::At(float alpha, float cosine) const {
  return FuzzAlbedoAt(LayerTables{nullptr, nullptr, table_.data(), mean_.data()}, alpha, cosine);
}

float FuzzAlbedo::Mean(float alpha) const {
  return FuzzAlbedoMean(LayerTables{nullptr, nullptr, table_.data(), mean_.data()}, alpha);
}

const DielectricAlbedo& DielectricAlbedoTable() {
  static const DielectricAlbedo table;
  return table;
}

const FuzzAlbedo& FuzzAlbedoTable() {
  static const FuzzAlbedo table;
  return table;
}

LayerTables LayerTablesFor(MaterialKind kind) {
  LayerTables tables;
  if (kind == MaterialKind::kPlastic) {
    tables.dielectric = DielectricAlbedoTable().table().data();
    tables.dielectric_mean = DielectricAlbedoTable().mean().data();
  } else if (kind == MaterialKind::kFuzz) {
    tables.fuzz = FuzzAlbedoTable().table().data();
    tables.fuzz_mean = FuzzAlbedoTable().mean().data();
  }
  return tables;
}

}  // namespace lfm
