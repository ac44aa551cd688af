// SPDX-License-Identifier: BSD-3-Clause
#include "encode/reflection_model.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>

#include "core/error.h"
#include "core/parallel.h"

namespace lfm {
namespace {

constexpr int kRounds = 8;
constexpr size_t kFewestViews = 6;
constexpr double kGainRidge = 0.01;   // squared sRGB-coded values, summed over views and channels
constexpr double kLightRidge = 1e-3;  // squared gains
constexpr double kMostGain = 3;
// Each texel takes part in its neighbours' sums by this, twice over: highlights are wider than
// texels, and not every texel is looked at.
constexpr double kSharing = 0.3;
constexpr int kSharingRounds = 2;

struct LightTap {
  std::array<int, 4> texel;
  std::array<double, 4> weight;
};

// An eye on the surface, or too far away to have a direction, looks from above.
LightTap TapAt(const Eigen::Vector3d& direction, int side) {
  Eigen::Vector3d d = direction / direction.cwiseAbs().sum();
  if (!d.allFinite()) d = Eigen::Vector3d::UnitZ();
  if (d.z() < 0) {
    const double x = std::copysign(1 - std::abs(d.y()), d.x());
    const double y = std::copysign(1 - std::abs(d.x()), d.y());
    d.x() = x;
    d.y() = y;
  }
  const double x = std::clamp((d.x() + 1) / 2, 0.0, 1.0) * (side - 1);
  const double y = std::clamp((d.y() + 1) / 2, 0.0, 1.0) * (side - 1);
  const int i = std::min(static_cast<int>(x), side - 2),
            j = std::min(static_cast<int>(y), side - 2);
  const double fx = x - i, fy = y - j;
  const int first = j * side + i;
  return {{first, first + 1, first + side, first + side + 1},
          {(1 - fx) * (1 - fy), fx * (1 - fy), (1 - fx) * fy, fx * fy}};
}

Eigen::Vector3d MirrorDirection(const Eigen::Vector3d& normal, const Eigen::Vector3d& to_eye) {
  return 2 * normal.dot(to_eye) * normal - to_eye;
}

// Where a triangle lies and which way it looks, smoothed over its corners.
struct Facing {
  Eigen::Vector3d centroid = Eigen::Vector3d::Zero(), normal = Eigen::Vector3d::Zero();
};

Facing FacingOf(const LightFieldSource& source, int triangle) {
  Facing facing;
  for (int c = 0; c < 3; ++c) {
    const int vertex = source.mesh.triangles[triangle][c];
    facing.centroid += source.mesh.vertices[vertex] / 3;
    facing.normal += source.vertex_frames[vertex].col(2);
  }
  const double length = facing.normal.norm();
  facing.normal = length > 1e-9 ? Eigen::Vector3d(facing.normal / length)
                                : source.vertex_frames[source.mesh.triangles[triangle][0]].col(2);
  return facing;
}

std::vector<Eigen::Vector3d> MirrorDirections(const LightFieldSource& source, int triangle) {
  const Facing facing = FacingOf(source, triangle);
  std::vector<Eigen::Vector3d> directions;
  for (const uint16_t photo : source.patch(triangle).photos) {
    const Eigen::Vector3d to_eye = source.eyes[photo] - facing.centroid;
    directions.push_back(MirrorDirection(facing.normal, to_eye.normalized()));
  }
  return directions;
}

struct View {
  LightTap tap;
  Eigen::Vector3d color;  // mean over the patch
};

std::vector<View> ViewsOf(const LightFieldSource& source, int triangle) {
  const TrianglePatch patch = source.patch(triangle);
  const size_t count = patch.photos.size();
  if (count < kFewestViews) return {};
  const std::vector<Eigen::Vector3d> directions = MirrorDirections(source, triangle);
  std::vector<View> views(count);
  const int samples = PatchSampleCount(patch.edge_samples);
  for (size_t v = 0; v < count; ++v) {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (int s = 0; s < samples; ++s) {
      for (int c = 0; c < 3; ++c) sum[c] += patch.values[(s * 3 + c) * count + v];
    }
    views[v] = {TapAt(directions[v], ReflectionModel{}.side),
                sum / (static_cast<double>(samples) * LightField::kOne)};
  }
  return views;
}

Eigen::Vector3d Look(const std::vector<Eigen::Vector3d>& light, const LightTap& tap) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (int k = 0; k < 4; ++k) sum += tap.weight[k] * light[tap.texel[k]];
  return sum;
}

struct TriangleFit {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();  // the colour without the light
  double gain = 1;
};

std::vector<Eigen::Vector3d> FitLight(const std::vector<std::vector<View>>& views,
                                      const std::vector<TriangleFit>& fits, int side) {
  // Right sides and diagonal of the normal equations, side by side.
  std::vector<Eigen::Vector4d> sums(static_cast<size_t>(side) * side, Eigen::Vector4d::Zero());
  for (size_t t = 0; t < views.size(); ++t) {
    for (const View& view : views[t]) {
      Eigen::Vector4d term;
      term << fits[t].gain * (view.color - fits[t].mean), fits[t].gain * fits[t].gain;
      for (int k = 0; k < 4; ++k) sums[view.tap.texel[k]] += view.tap.weight[k] * term;
    }
  }
  for (int round = 0; round < kSharingRounds; ++round) {
    const std::vector<Eigen::Vector4d> before = sums;
    for (int y = 0; y < side; ++y) {
      for (int x = 0; x < side; ++x) {
        Eigen::Vector4d& sum = sums[y * side + x];
        if (x > 0) sum += kSharing * before[y * side + x - 1];
        if (x + 1 < side) sum += kSharing * before[y * side + x + 1];
        if (y > 0) sum += kSharing * before[(y - 1) * side + x];
        if (y + 1 < side) sum += kSharing * before[(y + 1) * side + x];
      }
    }
  }
  std::vector<Eigen::Vector3d> light(sums.size());
  for (size_t i = 0; i < sums.size(); ++i)
    light[i] = sums[i].head<3>() / (sums[i][3] + kLightRidge);
  return light;
}

TriangleFit FitTriangle(const std::vector<View>& views, const std::vector<Eigen::Vector3d>& light) {
  TriangleFit fit;
  if (views.empty()) return {fit.mean, 0};
  const auto count = static_cast<double>(views.size());
  Eigen::Vector3d color = Eigen::Vector3d::Zero(), seen = Eigen::Vector3d::Zero();
  for (const View& view : views) {
    color += view.color / count;
    seen += Look(light, view.tap) / count;
  }
  double product = 0, square = kGainRidge;
  for (const View& view : views) {
    const Eigen::Vector3d difference = Look(light, view.tap) - seen;
    product += difference.dot(view.color - color);
    square += difference.squaredNorm();
  }
  fit.gain = std::clamp(product / square, 0.0, kMostGain);
  fit.mean = color - fit.gain * seen;
  return fit;
}

}  // namespace

Eigen::Vector3f ReflectionModel::LightAt(const Eigen::Vector3d& direction) const {
  const LightTap tap = TapAt(direction, side);
  Eigen::Vector3f sum = Eigen::Vector3f::Zero();
  for (int k = 0; k < 4; ++k) sum += static_cast<float>(tap.weight[k]) * light[tap.texel[k]];
  return sum;
}

ReflectionModel FitReflections(const LightFieldSource& source) {
  const auto triangles = static_cast<int64_t>(source.mesh.triangles.size());
  std::vector<std::vector<View>> views(triangles);
  ParallelFor(0, triangles, [&](int64_t t) {
    const int triangle = static_cast<int>(t);
    CheckSourceTriangle(source, triangle);
    for (const uint16_t photo : source.patch(triangle).photos) {
      if (photo >= source.eyes.size()) {
        throw Error("light field: a photograph's place is not known; run lfm-resample again");
      }
    }
    views[t] = ViewsOf(source, triangle);
  });
  ReflectionModel model;
  std::vector<Eigen::Vector3d> light(static_cast<size_t>(model.side) * model.side,
                                     Eigen::Vector3d::Zero());
  std::vector<TriangleFit> fits(triangles);
  for (int64_t t = 0; t < triangles; ++t) {
    fits[t].mean = FitTriangle(views[t], light).mean;  // no light yet: the mean colour
  }
  for (int round = 0; round < kRounds; ++round) {
    light = FitLight(views, fits, model.side);
    ParallelFor(
        0, triangles, [&](int64_t t) { fits[t] = FitTriangle(views[t], light); }, 64);
  }
  for (const Eigen::Vector3d& color : light) model.light.push_back(color.cast<float>());
  for (const TriangleFit& fit : fits) model.gain.push_back(static_cast<float>(fit.gain));
  return model;
}

LightFieldSource WithReflections(const LightFieldSource& source, ReflectionModel model) {
  LightFieldSource changed = source;
  const auto shared = std::make_shared<const ReflectionModel>(std::move(model));
  changed.change = [source, shared](int triangle, int corner, const ViewWeights& weights) {
    const int directions = source.grid * source.grid;
    std::vector<float> change(size_t{3} * directions, 0.f);
    const float gain = shared->gain[triangle];
    if (gain == 0 || weights.seen.empty()) return change;
    const Facing facing = FacingOf(source, triangle);
    std::vector<Eigen::Vector3f> seen;
    for (const Eigen::Vector3d& direction : MirrorDirections(source, triangle)) {
      seen.push_back(shared->LightAt(direction));
    }
    const Eigen::Matrix3d& frame = source.vertex_frames[source.mesh.triangles[triangle][corner]];
    for (int q = 0; q < directions; ++q) {
      const Eigen::Vector3d to_eye = frame * GridDirection(source.direction_map, source.grid, q);
      Eigen::Vector3f light = shared->LightAt(MirrorDirection(facing.normal, to_eye));
      for (int e = 3 * q; e < 3 * q + 3; ++e) light -= weights.weight[e] * seen[weights.view[e]];
      for (int c = 0; c < 3; ++c) change[c * directions + q] = gain * light[c];
    }
    return change;
  };
  return changed;
}

}  // namespace lfm
