// SPDX-License-Identifier: BSD-3-Clause
#include "fields/model_methods.h"

#include <algorithm>

#include "fields/field_encoding.h"
#include "fields/light_triangulation.h"
#include "fields/relightable_file.h"
#include "fields/relighting.h"

namespace lfm {
namespace {

// The light itself, as a vector over the model's directions.
LightVector LightOf(const LightTriangulation& lights, int channels,
                    const Eigen::Vector3d& to_light) {
  LightVector light = MakeLightVector(static_cast<int>(lights.directions.size()), channels);
  const LightShares shares = InterpolateLights(lights, to_light);
  for (int c = 0; c < channels; ++c) {
    for (int i = 0; i < 3; ++i) {
      light.Channel(c)[shares.light[i]] += static_cast<float>(shares.share[i]);
    }
  }
  return light;
}

// Channel after channel, none below 0.
std::vector<float> InRows(const std::vector<float>& interleaved, int64_t points, int channels) {
  std::vector<float> rows(interleaved.size());
  for (int64_t point = 0; point < points; ++point) {
    for (int c = 0; c < channels; ++c) {
      rows[c * points + point] = std::max(0.0f, interleaved[point * channels + c]);
    }
  }
  return rows;
}

}  // namespace

std::vector<LightMethod> ModelMethods(const RelightableModel& relightable, const std::string& name,
                                      const std::vector<int>& residuals) {
  const auto relighter = std::make_shared<const Relighter>(relightable);
  const LightTriangulation lights = TriangulateLights(relightable.directions);
  std::vector<LightMethod> methods;
  for (int count : residuals) {
    const std::string with = count < 0    ? ", all residuals"
                             : count == 0 ? ", no residual"
                                          : " + " + std::to_string(count) + " residuals";
    const int64_t bytes = CountBytes(WithFewerResiduals(relightable, count)).Total();
    methods.push_back(
        {name + with, name, bytes, [relighter, count, lights](const Eigen::Vector3d& to_light) {
           const LightVector light = LightOf(lights, relighter->channels(), to_light);
           return InRows(relighter->Relight(relighter->Prepare(light), count), relighter->points(),
                         relighter->channels());
         }});
  }
  return methods;
}

}  // namespace lfm
