// SPDX-License-Identifier: BSD-3-Clause
#include "encode/reflection_model.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <memory>

#include "core/error.h"
#include "core/parallel.h"

namespace lfm {
namespace {

constexpr int kMost = ReflectionModel::kMostLights;
constexpr int kSide = ReflectionModel{}.side;
constexpr int kRounds = 6;  // with each number of lights
constexpr size_t kFewestViews = 6;
// That lights are fitted to: triangles, and views of triangles.
constexpr int64_t kMostTriangles = 20000, kMostViews = 4'000'000;
constexpr double kGainRidge = 0.1;    // squared sRGB-coded values, summed over views and channels
constexpr double kLightRidge = 0.03;  // squared gains
constexpr double kSeparationRidge = 1e-3;  // a share of the gains' energy: lights that look alike
constexpr double kMostGain = 3;
// Each texel takes part in its neighbours' sums by this, twice over: highlights are wider than
// texels, and not every texel is looked at.
constexpr double kSharing = 0.3;
constexpr int kSharingRounds = 2;
constexpr int kBlurRounds = 6;  // of a light, as the start of the next

using Light = ReflectionModel::Light;
using Gains = Eigen::Matrix<double, kMost, 1>;

struct LightTap {
  int first = 0;  // texel; the others are at + 1, + side, + side + 1
  float fx = 0, fy = 0;

  std::array<int, 4> Texels(int side) const {
    return {first, first + 1, first + side, first + side + 1};
  }
  std::array<float, 4> Weights() const {
    return {(1 - fx) * (1 - fy), fx * (1 - fy), (1 - fx) * fy, fx * fy};
  }
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
  return {j * side + i, static_cast<float>(x - i), static_cast<float>(y - j)};
}

Eigen::Vector3f Look(const Light& light, int side, const LightTap& tap) {
  const std::array<int, 4> texels = tap.Texels(side);
  const std::array<float, 4> weights = tap.Weights();
  Eigen::Vector3f sum = Eigen::Vector3f::Zero();
  for (int k = 0; k < 4; ++k) sum += weights[k] * light[texels[k]];
  return sum;
}

Eigen::Vector3d MirrorDirection(const Eigen::Vector3d& normal, const Eigen::Vector3d& to_eye) {
  return 2 * normal.dot(to_eye) * normal - to_eye;
}

Eigen::Vector3d CornerNormal(const LightFieldSource& source, int triangle, int corner) {
  return source.vertex_frames[source.mesh.triangles[triangle][corner]].col(2);
}

// The normal that a corner's hat function sees in the mean: 1/2 its own, 1/4 the others'.
Eigen::Vector3d HatNormal(const LightFieldSource& source, int triangle, int corner) {
  Eigen::Vector3d sum = CornerNormal(source, triangle, corner);
  for (int c = 0; c < 3; ++c) sum += CornerNormal(source, triangle, c);
  const double length = sum.norm();
  return length > 1e-9 ? Eigen::Vector3d(sum / length) : CornerNormal(source, triangle, corner);
}

std::vector<Eigen::Vector3d> DirectionsToEyes(const LightFieldSource& source, int triangle) {
  Eigen::Vector3d centroid = Eigen::Vector3d::Zero();
  for (int c = 0; c < 3; ++c) {
    centroid += source.mesh.vertices[source.mesh.triangles[triangle][c]] / 3;
  }
  std::vector<Eigen::Vector3d> directions;
  for (const uint16_t photo : source.patch(triangle).photos) {
    directions.push_back((source.eyes[photo] - centroid).normalized());
  }
  return directions;
}

struct Observation {
  LightTap tap;
  Eigen::Vector3f color;
};

// What photographs show at the corners of a triangle: views of corner 0, of 1, of 2.
struct TriangleViews {
  int64_t count = 0;
  std::vector<Observation> observations;

  const Observation& At(int corner, int64_t view) const {
    return observations[corner * count + view];
  }
};

TriangleViews ViewsOf(const LightFieldSource& source, int triangle) {
  const TrianglePatch patch = source.patch(triangle);
  const size_t count = patch.photos.size();
  if (count < kFewestViews) return {};
  TriangleViews views;
  views.count = static_cast<int64_t>(count);
  views.observations.resize(3 * count);
  const std::vector<Eigen::Vector3d> to_eyes = DirectionsToEyes(source, triangle);
  const int n = patch.edge_samples;
  std::vector<double> sums(9 * count, 0.0);  // corner, channel, view
  Eigen::Vector3d hats = Eigen::Vector3d::Zero();
  for (int j = 0; j < n; ++j) {
    for (int i = 0; i + j < n; ++i) {
      const Eigen::Vector3d hat = PatchSampleWeights(n, i, j);
      hats += hat;
      const uint16_t* values = patch.values.data() + size_t{3} * PatchSampleIndex(n, i, j) * count;
      for (int corner = 0; corner < 3; ++corner) {
        double* sum = sums.data() + 3 * corner * count;
        for (size_t e = 0; e < 3 * count; ++e) sum[e] += hat[corner] * values[e];
      }
    }
  }
  for (int corner = 0; corner < 3; ++corner) {
    const Eigen::Vector3d normal = HatNormal(source, triangle, corner);
    for (size_t v = 0; v < count; ++v) {
      Observation& observation = views.observations[corner * count + v];
      observation.tap = TapAt(MirrorDirection(normal, to_eyes[v]), kSide);
      for (int c = 0; c < 3; ++c) {
        observation.color[c] = static_cast<float>(sums[(3 * corner + c) * count + v] /
                                                  (hats[corner] * LightField::kOne));
      }
    }
  }
  return views;
}

struct TriangleFit {
  std::array<Eigen::Vector3d, 3> mean = {Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero(),
                                         Eigen::Vector3d::Zero()};  // of a corner, without lights
  Gains gain = Gains::Unit(0);
};

// What lights show to a view, one column each.
using Shown = Eigen::Matrix<double, 3, kMost>;
Shown LookAtAll(const std::vector<Light>& lights, const LightTap& tap) {
  Shown shown = Shown::Zero();
  for (size_t k = 0; k < lights.size(); ++k) {
    shown.col(static_cast<int>(k)) = Look(lights[k], kSide, tap).cast<double>();
  }
  return shown;
}

TriangleFit FitTriangle(const TriangleViews& views, const std::vector<Light>& lights) {
  TriangleFit fit;
  fit.gain.setZero();
  if (views.count == 0) return fit;
  const auto count = static_cast<double>(views.count);
  std::array<Shown, 3> seen;
  Eigen::Matrix<double, kMost, kMost> squares = Eigen::Matrix<double, kMost, kMost>::Zero();
  Gains products = Gains::Zero();
  for (int corner = 0; corner < 3; ++corner) {
    Eigen::Vector3d color = Eigen::Vector3d::Zero();
    seen[corner].setZero();
    for (int64_t v = 0; v < views.count; ++v) {
      const Observation& view = views.At(corner, v);
      const Shown shown = LookAtAll(lights, view.tap);
      seen[corner] += shown / count;
      color += view.color.cast<double>() / count;
      squares += shown.transpose() * shown;
      products += shown.transpose() * view.color.cast<double>();
    }
    squares -= count * seen[corner].transpose() * seen[corner];
    products -= count * seen[corner].transpose() * color;
    fit.mean[corner] = color;
  }
  const auto used = static_cast<int>(lights.size());
  Eigen::MatrixXd normal = squares.topLeftCorner(used, used);
  normal.diagonal().array() += 3 * kGainRidge;
  fit.gain.head(used) = normal.ldlt().solve(products.head(used));
  for (double& gain : fit.gain) gain = std::clamp(gain, used == 1 ? 0 : -kMostGain, kMostGain);
  for (int corner = 0; corner < 3; ++corner) fit.mean[corner] -= seen[corner] * fit.gain;
  return fit;
}

// Normal equations of one texel: K x K, and K x 3 right sides.
using TexelSums = Eigen::Matrix<double, kMost, kMost + 3>;

std::vector<TexelSums> SumOverViews(const std::vector<TriangleViews>& views,
                                    const std::vector<TriangleFit>& fits) {
  const auto triangles = static_cast<int64_t>(views.size());
  constexpr int64_t kChunk = kMostTriangles / 8;
  std::vector<std::vector<TexelSums>> chunks((triangles + kChunk - 1) / kChunk);
  ParallelChunks(triangles, kChunk, [&](int64_t begin, int64_t end, int64_t chunk) {
    std::vector<TexelSums>& sums = chunks[chunk];
    sums.assign(kSide * kSide, TexelSums::Zero());
    for (int64_t t = begin; t < end; ++t) {
      const Gains& gain = fits[t].gain;
      TexelSums term;
      term.leftCols<kMost>() = gain * gain.transpose();
      for (int corner = 0; corner < 3; ++corner) {
        for (int64_t v = 0; v < views[t].count; ++v) {
          const Observation& view = views[t].At(corner, v);
          term.rightCols<3>() =
              gain * (view.color.cast<double>() - fits[t].mean[corner]).transpose();
          const std::array<int, 4> texels = view.tap.Texels(kSide);
          const std::array<float, 4> weights = view.tap.Weights();
          for (int k = 0; k < 4; ++k) sums[texels[k]] += weights[k] * term;
        }
      }
    }
  });
  std::vector<TexelSums> total(kSide * kSide, TexelSums::Zero());
  for (const std::vector<TexelSums>& sums : chunks) {
    for (size_t i = 0; i < total.size(); ++i) total[i] += sums[i];
  }
  return total;
}

// Adds `share` of the four neighbours; on the border of the map there are fewer.
template <typename T>
std::vector<T> WithNeighbors(const std::vector<T>& map, double share) {
  std::vector<T> result = map;
  for (int y = 0; y < kSide; ++y) {
    for (int x = 0; x < kSide; ++x) {
      T& sum = result[y * kSide + x];
      if (x > 0) sum += share * map[y * kSide + x - 1];
      if (x + 1 < kSide) sum += share * map[y * kSide + x + 1];
      if (y > 0) sum += share * map[(y - 1) * kSide + x];
      if (y + 1 < kSide) sum += share * map[(y + 1) * kSide + x];
    }
  }
  return result;
}

void FitLights(const std::vector<TriangleViews>& views, const std::vector<TriangleFit>& fits,
               std::vector<Light>& lights) {
  std::vector<TexelSums> sums = SumOverViews(views, fits);
  for (int round = 0; round < kSharingRounds; ++round) sums = WithNeighbors(sums, kSharing);
  const auto used = static_cast<int>(lights.size());
  for (size_t i = 0; i < sums.size(); ++i) {
    Eigen::MatrixXd normal = sums[i].topLeftCorner(used, used);
    const double apart = used > 1 ? kSeparationRidge * normal.trace() / used : 0;
    normal.diagonal().array() += kLightRidge + apart;
    const Eigen::MatrixXd solved = normal.ldlt().solve(sums[i].block(0, kMost, used, 3));
    for (int k = 0; k < used; ++k) lights[k][i] = solved.row(k).transpose().cast<float>();
  }
}

// A light as a rougher surface shows it, about.
Light Blurred(const Light& light) {
  std::vector<Eigen::Vector4d> map;  // and how many texels took part
  for (const Eigen::Vector3f& color : light) map.emplace_back(color.x(), color.y(), color.z(), 1);
  for (int round = 0; round < kBlurRounds; ++round) {
    map = WithNeighbors(map, 1);
    for (Eigen::Vector4d& value : map) value /= value[3];
  }
  Light blurred;
  for (const Eigen::Vector4d& value : map) blurred.push_back(value.head<3>().cast<float>());
  return blurred;
}

std::vector<Light> FitAllLights(const std::vector<TriangleViews>& views, int count) {
  const auto triangles = static_cast<int64_t>(views.size());
  std::vector<TriangleFit> fits(triangles);
  std::vector<Light> lights = {Light(kSide * kSide, Eigen::Vector3f::Zero())};
  const auto fit_triangles = [&] {
    ParallelFor(
        0, triangles, [&](int64_t t) { fits[t] = FitTriangle(views[t], lights); }, 64);
  };
  fit_triangles();  // no light yet: the mean colours
  for (TriangleFit& fit : fits) fit.gain[0] = 1;
  for (int k = 1; k <= count; ++k) {
    if (k > 1) {
      lights.push_back(Blurred(lights.back()));
      fit_triangles();
    }
    for (int round = 0; round < kRounds; ++round) {
      FitLights(views, fits, lights);
      fit_triangles();
    }
  }
  return lights;
}

void CheckEyes(const LightFieldSource& source, int triangle) {
  CheckSourceTriangle(source, triangle);
  for (const uint16_t photo : source.patch(triangle).photos) {
    if (photo >= source.eyes.size()) {
      source.Fail("a photograph's place is not known");
    }
  }
}

}  // namespace

ReflectionModel::Light ReflectionModel::ShownBy(int triangle) const {
  Light shown(static_cast<size_t>(side) * side, Eigen::Vector3f::Zero());
  for (size_t k = 0; k < lights.size(); ++k) {
    const float factor = gain[triangle * lights.size() + k];
    for (size_t i = 0; i < shown.size(); ++i) shown[i] += factor * lights[k][i];
  }
  return shown;
}

Eigen::Vector3f LookUp(const ReflectionModel::Light& light, int side,
                       const Eigen::Vector3d& direction) {
  return Look(light, side, TapAt(direction, side));
}

ReflectionModel FitReflections(const LightFieldSource& source, int lights) {
  if (lights < 1 || lights > kMost) {
    throw Error("mirror directions: lights must lie in [1, " + std::to_string(kMost) + "]");
  }
  const auto triangles = static_cast<int64_t>(source.mesh.triangles.size());
  const auto eyes = static_cast<int64_t>(std::max<size_t>(1, source.eyes.size()));
  const int64_t most = std::clamp<int64_t>(kMostViews / eyes, 1000, kMostTriangles);
  std::vector<TriangleViews> views(std::min(triangles, most));
  const auto chosen = static_cast<int64_t>(views.size());
  ParallelFor(
      0, triangles, [&](int64_t t) { CheckEyes(source, static_cast<int>(t)); }, 64);
  ParallelFor(0, chosen, [&](int64_t i) {
    views[i] = ViewsOf(source, static_cast<int>(i * triangles / chosen));
  });
  ReflectionModel model;
  model.lights = FitAllLights(views, lights);
  model.gain.resize(triangles * lights);
  ParallelFor(
      0, triangles,
      [&](int64_t t) {
        const Gains gain = FitTriangle(ViewsOf(source, static_cast<int>(t)), model.lights).gain;
        for (int k = 0; k < lights; ++k) model.gain[t * lights + k] = static_cast<float>(gain[k]);
      },
      64);
  return model;
}

LightFieldSource WithReflections(const LightFieldSource& source, ReflectionModel model) {
  LightFieldSource changed = source;
  const auto shared = std::make_shared<const ReflectionModel>(std::move(model));
  changed.change = [source, shared](int triangle, int corner, const ViewWeights& weights) {
    const int directions = source.grid * source.grid;
    std::vector<float> change(size_t{9} * directions, 0.f);
    const size_t lights = shared->lights.size();
    const auto gain = shared->gain.begin() + static_cast<std::ptrdiff_t>(triangle * lights);
    if (weights.seen.empty() || std::all_of(gain, gain + lights, [](float g) { return g == 0; })) {
      return change;
    }
    const Light shown = shared->ShownBy(triangle);
    const std::vector<Eigen::Vector3d> to_eyes = DirectionsToEyes(source, triangle);
    const Eigen::Matrix3d& frame = source.vertex_frames[source.mesh.triangles[triangle][corner]];
    std::vector<Eigen::Vector3f> seen(to_eyes.size());
    for (int at = 0; at < 3; ++at) {
      const Eigen::Vector3d normal = CornerNormal(source, triangle, at);
      for (size_t v = 0; v < to_eyes.size(); ++v) {
        seen[v] = LookUp(shown, shared->side, MirrorDirection(normal, to_eyes[v]));
      }
      for (int q = 0; q < directions; ++q) {
        const Eigen::Vector3d to_eye = frame * GridDirection(source.direction_map, source.grid, q);
        Eigen::Vector3f light = LookUp(shown, shared->side, MirrorDirection(normal, to_eye));
        for (int e = 3 * q; e < 3 * q + 3; ++e) light -= weights.weight[e] * seen[weights.view[e]];
        for (int c = 0; c < 3; ++c) change[(3 * at + c) * directions + q] = light[c];
      }
    }
    return change;
  };
  return changed;
}

}  // namespace lfm
