// SPDX-License-Identifier: BSD-3-Clause
#include "resample_views.h"

#include <map>
#include <string>

#include "calib/calib_files.h"
#include "core/error.h"
#include "resample/view_weights.h"

namespace lfm::bench {

Object LoadObject(const std::filesystem::path& work) {
  Object object{LightField::Open(work / "resample" / "light_field.lfs"), {}};
  std::map<std::string, Eigen::Vector3d> center_of;
  for (const PosedImage& photo : LoadCalib(work / "calib").photos) {
    center_of[photo.id] = photo.camera_from_world.Center();
  }
  for (const std::string& id : object.field.photo_ids()) {
    const auto place = center_of.find(id);
    if (place == center_of.end()) {
      throw Error("photograph " + id + " has no pose; run lfm-resample again");
    }
    object.centers.push_back(place->second);
  }
  return object;
}

Views ViewsOf(const Object& object, int triangle) {
  Views views{object.field.Patch(triangle), {}};
  const Eigen::Vector3i& corners = object.field.mesh().triangles[static_cast<size_t>(triangle)];
  Eigen::Vector3d centroid = Eigen::Vector3d::Zero();
  for (int c = 0; c < 3; ++c) {
    centroid += object.field.mesh().vertices[static_cast<size_t>(corners[c])] / 3;
  }
  for (const uint16_t photo : views.patch.photos) {
    views.to_eye.push_back((object.centers[photo] - centroid).normalized());
  }
  return views;
}

std::vector<Mix> MixesOf(std::span<const Eigen::Vector2d> plane, std::span<const size_t> from,
                         std::span<const Eigen::Vector2d> queries, double hull_margin) {
  std::vector<Eigen::Vector2d> sites;
  for (const size_t v : from) sites.push_back(plane[v]);
  const LightField::WeightBuffer weights = ComputeViewWeights(sites, queries, hull_margin);
  std::vector<Mix> mixes(queries.size());
  for (size_t q = 0; q < mixes.size(); ++q) {
    for (size_t k = 0; k < 3; ++k) {
      mixes[q].view[k] = from[weights.view[3 * q + k]];
      mixes[q].weight[k] = weights.weight[3 * q + k];
    }
    mixes[q].seen = weights.seen[q] != 0;
  }
  return mixes;
}

float Coded(const Views& views, size_t row, const Mix& mix) {
  float value = 0;
  for (size_t k = 0; k < 3; ++k) value += mix.weight[k] * views.At(row, mix.view[k]);
  return value;
}

}  // namespace lfm::bench
