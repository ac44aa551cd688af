// SPDX-License-Identifier: BSD-3-Clause
#include "sample_data/bsdf.h"

#include "core/error.h"
#include "sample_data/lanes/lane_convert.h"
#include "sample_data/lanes/lane_scattering.h"
#include "sample_data/layer_albedo.h"

namespace lfm {
namespace {

using V3f = Eigen::Vector3f;

static_assert(kMirrorAlpha == kLaneMirrorAlpha);
static_assert(static_cast<int32_t>(MaterialKind::kLambert) == kLaneLambert);
static_assert(static_cast<int32_t>(MaterialKind::kPhong) == kLanePhong);
static_assert(static_cast<int32_t>(MaterialKind::kConductor) == kLaneConductor);
static_assert(static_cast<int32_t>(MaterialKind::kPaint) == kLanePaint);
static_assert(static_cast<int32_t>(MaterialKind::kPlastic) == kLanePlastic);
static_assert(static_cast<int32_t>(MaterialKind::kGlass) == kLaneGlass);
static_assert(static_cast<int32_t>(MaterialKind::kFuzz) == kLaneFuzz);

void RequireRange(float value, float low, float high, const char* what, const std::string& where) {
  if (!(value >= low && value <= high)) {
    throw Error(where + ": material " + what + " is " + std::to_string(value) +
                "; give a number from " + std::to_string(low) + " to " + std::to_string(high));
  }
}

}  // namespace

BsdfValue EvaluateBsdf(const Material& material, const V3f& o, const V3f& i) {
  const LaneBsdf<float> value =
      EvaluateLanes(LayerTablesFor(material.kind), ToLane(material), ToLane(o), ToLane(i));
  return {FromLane(value.value), value.density};
}

BsdfSample SampleBsdf(const Material& material, const V3f& o, float u_lobe, float u1, float u2) {
  const LaneSample<float> drawn =
      SampleLanes(LayerTablesFor(material.kind), ToLane(material), ToLane(o), u_lobe, u1, u2);
  BsdfSample sample;
  sample.weight = FromLane(drawn.weight);
  if (sample.weight.isZero(0)) return sample;
  sample.direction = FromLane(drawn.direction);
  sample.density = drawn.density;
  sample.delta = drawn.delta != 0;
  sample.index_ratio2 = drawn.index_ratio2;
  return sample;
}

bool IsDelta(const Material& material) { return IsDeltaLane(ToLane(material)); }

void ValidateMaterial(const Material& material, const std::string& where) {
  for (int c = 0; c < 3; ++c) {
    RequireRange(material.diffuse[c], 0, 1, "diffuse", where);
    RequireRange(material.specular[c], 0, 1, "specular", where);
    RequireRange(material.absorption_per_mm[c], 0, 1e6f, "absorption", where);
  }
  RequireRange(material.exponent, 0, 1e7f, "exponent", where);
  RequireRange(material.alpha_u, 0, 1, "roughness", where);
  RequireRange(material.alpha_v, 0, 1, "roughness", where);
  RequireRange(material.ior, 0.2f, 5, "index", where);
}

}  // namespace lfm
