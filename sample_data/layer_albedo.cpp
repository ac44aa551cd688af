// SPDX-License-Identifier: BSD-3-Clause
#include "sample_data/layer_albedo.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "sample_data/fresnel.h"
#include "sample_data/fuzz.h"
#include "sample_data/microfacet.h"

namespace lfm {
namespace {

using V3f = Eigen::Vector3f;

constexpr int kCosines = 24, kIndices = 13, kAlphas = 11, kFuzzAlphas = 24;
constexpr float kIndexStep = 0.125f;
constexpr float kPi = std::numbers::pi_v<float>;

// Nodes are denser where albedos change fastest: near grazing.
float NodeCosine(int j) {
  const float x = static_cast<float>(j) / (kCosines - 1);
  return x * x;
}

struct Place {
  int index;
  float t;
};
Place Locate(float x, int nodes) {
  const float clamped = std::clamp(x, 0.0f, static_cast<float>(nodes - 1));
  const int i = std::min(static_cast<int>(clamped), nodes - 2);
  return {i, clamped - static_cast<float>(i)};
}

Place LocateCosine(float cosine) {
  return Locate(std::sqrt(std::max(0.0f, cosine)) * (kCosines - 1), kCosines);
}

float Along(const float* row, const Place& c) {
  return row[c.index] + c.t * (row[c.index + 1] - row[c.index]);
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
  const V3f o(std::sqrt(1 - c * c), 0, c);
  const float so = GgxStretch(o, alpha, alpha);
  constexpr int kSamples = 512;
  double sum = 0;
  for (int s = 0; s < kSamples; ++s) {
    const float u1 = (static_cast<float>(s) + 0.5f) / kSamples;
    const double golden = s * 0.6180339887498949;
    const V3f h =
        SampleGgxNormal(o, alpha, alpha, u1, static_cast<float>(golden - std::floor(golden)));
    const float oh = o.dot(h);
    const V3f i = 2 * oh * h - o;
    if (i.z() <= 0) continue;
    const float si = GgxStretch(i, alpha, alpha);
    sum += DielectricFresnel(oh, ior) * i.z() * (o.z() + so) / (so * i.z() + si * o.z());
  }
  return static_cast<float>(sum / kSamples);
}

float WhiteFuzz(float alpha, float cosine) {
  const float c = std::max(cosine, 1e-3f);
  const V3f o(std::sqrt(1 - c * c), 0, c);
  constexpr int kSteps = 32;
  double sum = 0;
  for (int a = 0; a < kSteps; ++a) {
    // Squared nodes: fibres reflect most near the horizon.
    const float x = (static_cast<float>(a) + 0.5f) / kSteps, z = x * x;
    for (int b = 0; b < kSteps; ++b) {
      const float phi = kPi * (static_cast<float>(b) + 0.5f) / kSteps;
      const float s = std::sqrt(1 - z * z);
      sum += FuzzReflection(o, {s * std::cos(phi), s * std::sin(phi), z}, alpha) * z * 2 * x;
    }
  }
  return static_cast<float>(sum * 2 * kPi / (kSteps * kSteps));
}

float FuzzNodeAlpha(int a) {
  return kFuzzSmoothest + (1 - kFuzzSmoothest) * static_cast<float>(a) / (kFuzzAlphas - 1);
}
Place LocateFuzz(float alpha) {
  return Locate((alpha - kFuzzSmoothest) / (1 - kFuzzSmoothest) * (kFuzzAlphas - 1), kFuzzAlphas);
}

}  // namespace

DielectricAlbedo::DielectricAlbedo() {
  for (int n = 0; n < kIndices; ++n) {
    const float ior = 1 + kIndexStep * static_cast<float>(n);
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
  const Place n = Locate((ior - 1) / kIndexStep, kIndices);
  const Place a = Locate(alpha * (kAlphas - 1), kAlphas), c = LocateCosine(cosine);
  const auto row = [&](int dn, int da) {
    const size_t r = static_cast<size_t>(n.index + dn) * kAlphas + a.index + da;
    return Along(&table_[r * kCosines], c);
  };
  const float low = row(0, 0) + a.t * (row(0, 1) - row(0, 0));
  const float high = row(1, 0) + a.t * (row(1, 1) - row(1, 0));
  return low + n.t * (high - low);
}

float DielectricAlbedo::Mean(float ior, float alpha) const {
  const Place n = Locate((ior - 1) / kIndexStep, kIndices);
  const Place a = Locate(alpha * (kAlphas - 1), kAlphas);
  const float* row = &mean_[static_cast<size_t>(n.index) * kAlphas + a.index];
  const float low = row[0] + a.t * (row[1] - row[0]);
  const float high = row[kAlphas] + a.t * (row[kAlphas + 1] - row[kAlphas]);
  return low + n.t * (high - low);
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
  const Place a = LocateFuzz(alpha), c = LocateCosine(cosine);
  const float low = Along(&table_[static_cast<size_t>(a.index) * kCosines], c);
  const float high = Along(&table_[static_cast<size_t>(a.index + 1) * kCosines], c);
  return low + a.t * (high - low);
}

float FuzzAlbedo::Mean(float alpha) const {
  const Place a = LocateFuzz(alpha);
  return mean_[a.index] + a.t * (mean_[a.index + 1] - mean_[a.index]);
}

const DielectricAlbedo& DielectricAlbedoTable() {
  static const DielectricAlbedo table;
  return table;
}

const FuzzAlbedo& FuzzAlbedoTable() {
  static const FuzzAlbedo table;
  return table;
}

}  // namespace lfm
