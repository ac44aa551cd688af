// SPDX-License-Identifier: BSD-3-Clause
#include "sample_data/light_transport.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/error.h"
#include "sample_data/bsdf.h"

namespace lfm {
namespace {

using V3f = Eigen::Vector3f;

constexpr float kFar = std::numeric_limits<float>::infinity();
constexpr int kRouletteFrom = 8, kLongestPath = 32;
constexpr uint64_t kTexelStream = 0x7e7e1, kPathStream = 0x9a755;

// Density over directions (1/sr) of `samples` points a texel, drawn evenly over the cube's face,
// for a direction whose point on the cube lies at `distance` from its middle.
float TexelDensity(const TransportOptions& options, float distance) {
  const float side = 2 / static_cast<float>(options.cube.resolution);
  return static_cast<float>(options.samples_per_texel) * distance * distance * distance /
         (side * side);
}

float CubeDistance(const V3f& direction) { return 1 / direction.cwiseAbs().maxCoeff(); }

bool SameSide(const SurfacePoint& surface, const V3f& local, const V3f& direction) {
  const float facet = surface.facet.dot(direction);
  if (surface.material.kind == MaterialKind::kGlass) return facet * local.z() > 0;
  return facet > 0 && local.z() > 0;
}

bool Uncounted(const Material& material) {
  return IsDelta(material) || material.kind == MaterialKind::kGlass;
}

void Deposit(float* row, int texel, const V3f& value) {
  for (int c = 0; c < 3; ++c) row[3 * static_cast<size_t>(texel) + c] += value[c];
}

// How wide the narrowest lobe is, radians; far more than a texel for those without a peak.
float LobeWidth(const Material& m) {
  switch (m.kind) {
    case MaterialKind::kPhong:
      return m.specular.isZero(0) ? 1 : std::sqrt(2 / (m.exponent + 2));
    case MaterialKind::kConductor:
    case MaterialKind::kPlastic:
      return 2 * std::min(m.alpha_u, m.alpha_v);
    case MaterialKind::kPaint:
    case MaterialKind::kGlass:
      return 2 * m.alpha_u;
    case MaterialKind::kLambert:
    case MaterialKind::kFuzz:
      break;
  }
  return 1;
}

bool HasDeltaLobe(const Material& m) {
  return IsDelta(m) ||
         (m.kind == MaterialKind::kPlastic && std::max(m.alpha_u, m.alpha_v) < kMirrorAlpha);
}

// Shadow rays, sixteen at a time.
class ShadowRays {
 public:
  template <typename Passed>
  void Add(const TracedScene& scene, const V3f& origin, const V3f& direction, int texel,
           const V3f& value, const Passed& passed) {
    RTCRay16& r = packet_.rays;
    const int i = lanes_++;
    r.org_x[i] = origin.x();
    r.org_y[i] = origin.y();
    r.org_z[i] = origin.z();
    r.dir_x[i] = direction.x();
    r.dir_y[i] = direction.y();
    r.dir_z[i] = direction.z();
    r.tnear[i] = r.time[i] = 0;
    r.tfar[i] = kFar;
    r.mask[i] = ~0u;
    r.id[i] = r.flags[i] = 0;
    texels_[i] = texel;
    values_[i] = value;
    if (lanes_ == 16) Flush(scene, passed);
  }
  template <typename Passed>
  void Flush(const TracedScene& scene, const Passed& passed) {
    if (lanes_ == 0) return;
    for (int i = 0; i < 16; ++i) packet_.valid[i] = i < lanes_ ? -1 : 0;
    scene.Occlude(packet_.valid, packet_.rays, RayOrder::kCoherent);
    for (int i = 0; i < lanes_; ++i) {
      if (packet_.rays.tfar[i] >= 0) passed(texels_[i], values_[i]);
    }
    count_ += lanes_;
    lanes_ = 0;
  }
  int64_t count() const { return count_; }

 private:
  ShadowPacket packet_ = {};
  int texels_[16] = {};
  V3f values_[16];
  int lanes_ = 0;
  int64_t count_ = 0;
};

}  // namespace

struct TransportRow::Gathering {
  const SurfacePoint& surface;
  V3f to_eye, o;
  uint64_t stream;
  float weight;
  float* row;
  enum Direct { kMiddles, kRandom, kPathsAlone } direct = kMiddles;
  RayCounts rays;
};

TransportRow::TransportRow(const TracedScene& scene, const TransportOptions& options)
    : scene_(scene), options_(options) {
  if (options.cube.resolution < 1 || options.cube.resolution > 1024) {
    throw Error("the cube map's resolution is " + std::to_string(options.cube.resolution) +
                "; give a number from 1 to 1024");
  }
  if (options.samples_per_texel < 1) throw Error("light transport needs a sample a texel at least");
  if (options.paths < 0 || options.bounces < 0) {
    throw Error("light transport: paths and bounces must not be negative");
  }
  for (int i = 0; i < options.cube.Texels(); ++i) middles_.push_back(options.cube.Direction(i));
}

RayCounts TransportRow::Add(const SurfacePoint& surface, const V3f& to_eye, uint64_t stream,
                            float weight, float* row) const {
  const Material& m = surface.material;
  Gathering g{surface, to_eye, surface.frame.Local(to_eye), stream,
              weight,  row,    Gathering::kMiddles,         {}};
  const float texel = 2 / static_cast<float>(options_.cube.resolution);
  if (IsDelta(m)) {
    g.direct = Gathering::kPathsAlone;
  } else if (!HasDeltaLobe(m) && LobeWidth(m) < texel / 6) {
    g.direct = Gathering::kRandom;
  }
  if (g.direct == Gathering::kMiddles) AddMiddles(g);
  if (g.direct == Gathering::kRandom) AddRandomPoints(g);
  if (g.direct != Gathering::kMiddles || options_.bounces > 0 || HasDeltaLobe(m) ||
      scene_.HasSpecularPaths()) {
    AddPaths(g);
  }
  return g.rays;
}

void TransportRow::AddMiddles(Gathering& g) const {
  const CubeMap& cube = options_.cube;
  const SurfacePoint& surface = g.surface;
  const bool glass = surface.material.kind == MaterialKind::kGlass;
  const float texel = 2 / static_cast<float>(cube.resolution);
  const float lobe = HasDeltaLobe(surface.material) ? 1 : LobeWidth(surface.material);
  const int fine = std::clamp(static_cast<int>(std::ceil(2 * texel / lobe)), 1, 8);
  const V3f mirrored = surface.frame.World({-g.o.x(), -g.o.y(), g.o.z()});
  const float near_cosine = std::cos(std::min(3.1f, texel + 6 * lobe));
  const int side =
      std::max(1, static_cast<int>(std::lround(std::sqrt(options_.samples_per_texel))));
  const float part = 1 / static_cast<float>(side * side);
  ShadowRays shadows;
  const auto passed = [&](int t, const V3f& value) { Deposit(g.row, t, value); };
  for (int t = 0; t < cube.Texels(); ++t) {
    if (!glass && surface.frame.z.dot(middles_[t]) < -texel) continue;
    const int steps = glass || mirrored.dot(middles_[t]) > near_cosine ? fine : 1;
    V3f value = V3f::Zero();
    for (int y = 0; y < steps; ++y) {
      for (int x = 0; x < steps; ++x) {
        const float inverse = 1 / static_cast<float>(steps);
        const V3f point = cube.Point(t, (static_cast<float>(x) + 0.5f) * inverse,
                                     (static_cast<float>(y) + 0.5f) * inverse);
        const float distance = point.norm();
        const V3f i = surface.frame.Local(point / distance);
        if (!SameSide(surface, i, point)) continue;
        const float solid_angle =
            texel * texel * inverse * inverse / (distance * distance * distance);
        value += solid_angle * EvaluateBsdf(surface.material, g.o, i).value;
      }
    }
    if (value.isZero(0)) continue;
    value *= g.weight * part;
    for (int s = 0; s < side * side; ++s) {
      const V3f direction =
          cube.Point(t, (static_cast<float>(s % side) + 0.5f) / static_cast<float>(side),
                     (static_cast<float>(s / side) + 0.5f) / static_cast<float>(side))
              .normalized();
      // A texel that the horizon cuts: what reaches the surface comes from above.
      if (!glass && surface.facet.dot(direction) <= 0) {
        const V3f lifted =
            (direction - (surface.facet.dot(direction) - 1e-3f) * surface.facet).normalized();
        shadows.Add(scene_, TracedScene::Departure(surface, lifted), lifted, t, value, passed);
        continue;
      }
      shadows.Add(scene_, TracedScene::Departure(surface, direction), direction, t, value, passed);
    }
  }
  shadows.Flush(scene_, passed);
  g.rays.shadow += shadows.count();
}

void TransportRow::AddRandomPoints(Gathering& g) const {
  const SurfacePoint& surface = g.surface;
  const float reach = 2 / static_cast<float>(options_.cube.resolution);
  const bool glass = surface.material.kind == MaterialKind::kGlass;
  RandomStream random(options_.seed, kTexelStream, g.stream);
  ShadowRays shadows;
  const auto passed = [&](int t, const V3f& value) { Deposit(g.row, t, value); };
  for (int t = 0; t < options_.cube.Texels(); ++t) {
    if (!glass && surface.frame.z.dot(middles_[t]) < -reach) continue;
    for (int s = 0; s < options_.samples_per_texel; ++s) {
      const float x = static_cast<float>(random.Uniform());
      const float y = static_cast<float>(random.Uniform());
      const V3f point = options_.cube.Point(t, x, y);
      const float distance = point.norm();
      const V3f direction = point / distance, i = surface.frame.Local(direction);
      if (!SameSide(surface, i, direction)) continue;
      const BsdfValue bsdf = EvaluateBsdf(surface.material, g.o, i);
      if (bsdf.value.isZero(0)) continue;
      const float density = TexelDensity(options_, distance) +
                            static_cast<float>(std::max(1, options_.paths)) * bsdf.density;
      shadows.Add(scene_, TracedScene::Departure(surface, direction), direction, t,
                  g.weight / density * bsdf.value, passed);
    }
  }
  shadows.Flush(scene_, passed);
  g.rays.shadow += shadows.count();
}

void TransportRow::AddPaths(Gathering& g) const {
  struct Path {
    V3f origin, direction, throughput = V3f::Ones(), absorption = V3f::Zero();
    PathKey key;
    float index_ratio2 = 1;
    int bounces = 0, surfaces = 0;
    bool inside = false, asked = false;  // asked: its texel was asked where it began
    float density = 0;
  };
  std::vector<Path> paths, next;
  // Draws where the path goes on; false when it ends.
  const auto scatter = [&](Path& path, const SurfacePoint& point, const V3f& back) {
    const auto dimension = static_cast<uint32_t>(2 * path.surfaces);
    const auto lobe = RandomPair(path.key, dimension), u = RandomPair(path.key, dimension + 1);
    const BsdfSample sample =
        SampleBsdf(point.material, point.frame.Local(back), lobe[0], u[0], u[1]);
    if (sample.weight.isZero(0)) return false;
    const V3f direction = point.frame.World(sample.direction).normalized();
    if (!SameSide(point, sample.direction, direction)) return false;
    path.throughput = path.throughput.cwiseProduct(sample.weight);
    path.index_ratio2 *= sample.index_ratio2;
    path.bounces += !Uncounted(point.material);
    if (point.material.kind == MaterialKind::kGlass) {
      path.inside = sample.direction.z() < 0 && !point.material.absorption_per_mm.isZero(0);
      path.absorption = point.material.absorption_per_mm;
    }
    path.asked = path.surfaces == 0 && !sample.delta;
    path.density = sample.density;
    path.origin = TracedScene::Departure(point, direction);
    path.direction = direction;
    if (++path.surfaces >= kRouletteFrom) {
      const float survival = std::min(0.95f, path.index_ratio2 * path.throughput.maxCoeff());
      if (!(lobe[1] < survival)) return false;
      path.throughput /= survival;
    }
    return true;
  };
  const int count = std::max(1, options_.paths);
  const float share = g.weight / static_cast<float>(count);
  for (int p = 0; p < count; ++p) {
    Path path;
    path.key = {
        MakeSetKey(options_.seed ^ kPathStream, g.stream, static_cast<uint64_t>(p / kSetSize)),
        static_cast<uint32_t>(p % kSetSize)};
    if (scatter(path, g.surface, g.to_eye)) paths.push_back(path);
  }
  while (!paths.empty()) {
    next.clear();
    g.rays.bounce += static_cast<int64_t>(paths.size());
    for (size_t first = 0; first < paths.size(); first += 16) {
      const int lanes = static_cast<int>(std::min<size_t>(16, paths.size() - first));
      RayPacket packet;
      for (int i = 0; i < lanes; ++i) {
        packet.Set(i, paths[first + i].origin, paths[first + i].direction, 0, kFar);
      }
      scene_.Intersect(packet, RayOrder::kScattered);
      for (int i = 0; i < lanes; ++i) {
        Path& path = paths[first + i];
        if (packet.rays.hit.geomID[i] == RTC_INVALID_GEOMETRY_ID) {
          float w = share;
          if (path.asked && g.direct == Gathering::kMiddles) continue;
          if (path.asked && g.direct == Gathering::kRandom) {
            const float mine = static_cast<float>(count) * path.density;
            w *= mine / (mine + TexelDensity(options_, CubeDistance(path.direction)));
          }
          Deposit(g.row, options_.cube.TexelOf(path.direction), w * path.throughput);
          continue;
        }
        if (path.surfaces >= kLongestPath) continue;
        if (path.inside) {
          path.throughput.array() *= (-packet.rays.ray.tfar[i] * path.absorption.array()).exp();
        }
        const SurfacePoint point = scene_.Surface(packet, i, path.direction);
        if (path.bounces > options_.bounces && !Uncounted(point.material)) continue;
        if (scatter(path, point, -path.direction)) next.push_back(path);
      }
    }
    paths.swap(next);
  }
}

int TransportRow::AddRay(const V3f& origin, const V3f& direction, uint64_t stream, float weight,
                         float* row, RayCounts* rays) const {
  RayPacket packet;
  packet.Set(0, origin, direction, 0, kFar);
  scene_.Intersect(packet, RayOrder::kCoherent);
  if (rays != nullptr) rays->camera += 1;
  if (packet.rays.hit.geomID[0] == RTC_INVALID_GEOMETRY_ID) {
    Deposit(row, options_.cube.TexelOf(direction), V3f::Constant(weight));
    return -2;
  }
  const SurfacePoint surface = scene_.Surface(packet, 0, direction);
  const RayCounts used = Add(surface, -direction, stream, weight, row);
  if (rays != nullptr) *rays += used;
  return surface.object;
}

}  // namespace lfm
