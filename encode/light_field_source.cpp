// SPDX-License-Identifier: BSD-3-Clause
#include "encode/light_field_source.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "core/error.h"

namespace lfm {
namespace {

[[noreturn]] void Fail(const LightFieldSource& source, int triangle, const std::string& problem) {
  source.Fail("triangle " + std::to_string(triangle) + ": " + problem);
}

void CheckWeights(const LightFieldSource& source, const ViewWeights& weights, size_t views,
                  int triangle) {
  const size_t directions = static_cast<size_t>(source.grid) * source.grid;
  if (weights.view.size() != 3 * directions || weights.weight.size() != 3 * directions ||
      weights.seen.size() != directions) {
    Fail(source, triangle, "view weights do not fill the view grid");
  }
  for (const uint16_t view : weights.view) {
    if (view >= views) Fail(source, triangle, "a view weight names a view that is not there");
  }
  for (size_t q = 0; q < directions; ++q) {
    const float* w = weights.weight.data() + 3 * q;
    const bool positive = w[0] >= 0 && w[1] >= 0 && w[2] >= 0;
    if (!positive || !(std::abs(w[0] + w[1] + w[2] - 1) <= 1e-3f)) {
      Fail(source, triangle, "view weights are negative or do not sum to one");
    }
  }
}

}  // namespace

void LightFieldSource::Fail(const std::string& problem) const {
  throw Error(name + ": " + problem + "; run lfm-resample again");
}

LightFieldSource SourceFromLightField(const LightField& light_field,
                                      std::vector<Eigen::Vector3d> eyes) {
  const LightField* field = &light_field;
  return {light_field.mesh(),
          light_field.vertex_frames(),
          light_field.direction_map(),
          light_field.grid(),
          [field](int triangle) { return field->Patch(triangle); },
          [field](int triangle, int corner, LightField::WeightBuffer& buffer) {
            return field->Weights(triangle, corner, buffer);
          },
          light_field.DenseBytes(),
          std::move(eyes),
          {},
          light_field.name()};
}

std::vector<Eigen::Vector3d> EyesOfPhotos(const CalibResult& calib,
                                          const std::vector<std::string>& photo_ids,
                                          const std::string& name) {
  std::vector<Eigen::Vector3d> eyes;
  for (const std::string& id : photo_ids) {
    const auto posed = std::find_if(calib.photos.begin(), calib.photos.end(),
                                    [&](const PosedImage& photo) { return photo.id == id; });
    if (posed == calib.photos.end()) {
      throw Error(name + ": photograph '" + id +
                  "' has no pose in the calibration; run lfm-resample again");
    }
    eyes.push_back(posed->camera_from_world.Center());
  }
  return eyes;
}

void CheckSourceTriangle(const LightFieldSource& source, int triangle) {
  const TrianglePatch patch = source.patch(triangle);
  if (patch.edge_samples < 2 || patch.edge_samples > 4096) {
    Fail(source, triangle, "edge samples must lie in [2, 4096]");
  }
  const size_t samples = static_cast<size_t>(PatchSampleCount(patch.edge_samples));
  if (patch.values.size() != samples * 3 * patch.photos.size()) {
    Fail(source, triangle, "the patch does not hold samples x 3 x views values");
  }
  if (patch.photos.empty()) return;
  LightField::WeightBuffer buffer;
  for (int corner = 0; corner < 3; ++corner) {
    CheckWeights(source, source.weights(triangle, corner, buffer), patch.photos.size(), triangle);
  }
}

}  // namespace lfm
