// SPDX-License-Identifier: BSD-3-Clause
#include "sample_data/directional_response.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/error.h"
#include "sample_data/bsdf.h"
#include "sample_data/sample_sequence.h"

namespace lfm {
namespace {

using V3f = Eigen::Vector3f;

constexpr float kFar = std::numeric_limits<float>::infinity();
constexpr int kLanes = 16, kLongestPath = 32, kMostBounces = 64;
constexpr float kUnitLength_abs = 1e-4f;

bool OnSameSide(const SurfacePoint& point, const V3f& local, const V3f& direction) {
  const float facet = point.facet.dot(direction);
  if (point.material.kind == MaterialKind::kGlass) return facet * local.z() > 0;
  return facet > 0 && local.z() > 0;
}

bool CountsAsBounce(const Material& material) {
  return !IsDelta(material) && material.kind != MaterialKind::kGlass;
}

void SetLane(ShadowPacket& packet, int lane, const V3f& origin, const V3f& direction) {
  RTCRay16& r = packet.rays;
  r.org_x[lane] = origin.x();
  r.org_y[lane] = origin.y();
  r.org_z[lane] = origin.z();
  r.dir_x[lane] = direction.x();
  r.dir_y[lane] = direction.y();
  r.dir_z[lane] = direction.z();
  r.tnear[lane] = r.time[lane] = 0;
  r.tfar[lane] = kFar;
  r.mask[lane] = ~0u;
  r.id[lane] = r.flags[lane] = 0;
}

}  // namespace

struct DirectionalResponse::Path {
  PathRay ray;
  V3f throughput = V3f::Ones(), absorption = V3f::Zero();
  int surfaces = 0, bounces = 0;
  bool inside = false;
};

DirectionalResponse::DirectionalResponse(const TracedScene& scene, std::vector<V3f> to_lights,
                                         float irradiance, int bounces, float indirect_limit)
    : scene_(scene),
      to_lights_(std::move(to_lights)),
      irradiance_(irradiance),
      bounces_(bounces),
      indirect_limit_(indirect_limit) {
  if (!(indirect_limit > 0)) throw Error("the limit of indirect light must be above 0");
  if (to_lights_.empty()) throw Error("a reflectance field needs at least one light direction");
  for (const V3f& l : to_lights_) {
    if (!(std::abs(l.norm() - 1) <= kUnitLength_abs)) {
      throw Error("a light's direction is not a unit vector; divide it by its length");
    }
  }
  if (bounces < 0 || bounces > kMostBounces) {
    throw Error("bounces is " + std::to_string(bounces) + "; give a number from 0 to 64");
  }
}

void DirectionalResponse::AskLights(const SurfacePoint& point, const Path& path, float weight,
                                    float* row, RayCounts& counts) const {
  if (IsDelta(point.material)) return;
  const V3f o = point.frame.Local(-path.ray.direction);
  ShadowPacket packet = {};
  size_t lights[kLanes];
  V3f values[kLanes];
  int lanes = 0;
  const auto flush = [&] {
    for (int i = 0; i < kLanes; ++i) packet.valid[i] = i < lanes ? -1 : 0;
    scene_.Occlude(packet.valid, packet.rays, RayOrder::kCoherent);
    for (int i = 0; i < lanes; ++i) {
      if (packet.rays.tfar[i] < 0) continue;
      for (int c = 0; c < 3; ++c) row[3 * lights[i] + c] += values[i][c];
    }
    counts.shadow += lanes;
    lanes = 0;
  };
  for (size_t l = 0; l < to_lights_.size(); ++l) {
    const V3f i = point.frame.Local(to_lights_[l]);
    if (!OnSameSide(point, i, to_lights_[l])) continue;
    V3f value =
        irradiance_ * path.throughput.cwiseProduct(EvaluateBsdf(point.material, o, i).value);
    if (value.isZero(0)) continue;
    const float most = value.maxCoeff();
    if (path.bounces > 0 && most > indirect_limit_) value *= indirect_limit_ / most;
    value *= weight;
    lights[lanes] = l;
    values[lanes] = value;
    SetLane(packet, lanes++, TracedScene::Departure(point, to_lights_[l]), to_lights_[l]);
    if (lanes == kLanes) flush();
  }
  if (lanes > 0) flush();
}

bool DirectionalResponse::Scatter(const SurfacePoint& point, Path& path) const {
  const bool counts = CountsAsBounce(point.material);
  if (counts && path.bounces >= bounces_) return false;
  if (++path.surfaces >= kLongestPath) return false;
  const auto dimension = static_cast<uint32_t>(2 * path.surfaces);
  const auto lobe = RandomPair(path.ray.key, dimension);
  const auto u = RandomPair(path.ray.key, dimension + 1);
  const BsdfSample sample =
      SampleBsdf(point.material, point.frame.Local(-path.ray.direction), lobe[0], u[0], u[1]);
  if (sample.weight.isZero(0)) return false;
  const V3f direction = point.frame.World(sample.direction).normalized();
  if (!OnSameSide(point, sample.direction, direction)) return false;
  path.throughput = path.throughput.cwiseProduct(sample.weight);
  path.bounces += counts ? 1 : 0;
  if (point.material.kind == MaterialKind::kGlass) {
    path.inside = sample.direction.z() < 0 && !point.material.absorption_per_mm.isZero(0);
    path.absorption = point.material.absorption_per_mm;
  }
  path.ray.origin = TracedScene::Departure(point, direction);
  path.ray.direction = direction;
  return true;
}

RayCounts DirectionalResponse::Add(const std::vector<PathRay>& rays, float weight,
                                   float* row) const {
  RayCounts counts;
  counts.camera += static_cast<int64_t>(rays.size());
  std::vector<Path> paths, next;
  for (const PathRay& ray : rays) {
    Path path;
    path.ray = ray;
    paths.push_back(path);
  }
  RayOrder order = RayOrder::kCoherent;
  while (!paths.empty()) {
    next.clear();
    for (size_t first = 0; first < paths.size(); first += kLanes) {
      const int lanes = static_cast<int>(std::min<size_t>(kLanes, paths.size() - first));
      RayPacket packet;
      for (int i = 0; i < lanes; ++i) {
        const PathRay& ray = paths[first + static_cast<size_t>(i)].ray;
        packet.Set(i, ray.origin, ray.direction, 0, kFar);
      }
      scene_.Intersect(packet, order);
      for (int i = 0; i < lanes; ++i) {
        Path& path = paths[first + static_cast<size_t>(i)];
        if (packet.rays.hit.geomID[i] == RTC_INVALID_GEOMETRY_ID) continue;
        if (path.inside) {
          path.throughput.array() *= (-packet.rays.ray.tfar[i] * path.absorption.array()).exp();
        }
        const SurfacePoint point = scene_.Surface(packet, i, path.ray.direction);
        AskLights(point, path, weight, row, counts);
        if (Scatter(point, path)) next.push_back(path);
      }
    }
    paths.swap(next);
    counts.bounce += static_cast<int64_t>(paths.size());
    order = RayOrder::kScattered;
  }
  return counts;
}

}  // namespace lfm
