// SPDX-License-Identifier: BSD-3-Clause
#include "bench/phong_sphere.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <vector>

#include "core/image.h"
#include "fields/clustered_pca.h"

namespace lfm::bench {
namespace {

constexpr int kSize = 96, kCube = 16;

struct Sphere {
  FunctionRows rows;
  std::vector<Eigen::Vector2d> places;  // of a row's pixel, from the middle, radius 1
};

std::vector<Eigen::Vector3d> CubeDirections() {
  std::vector<Eigen::Vector3d> directions;
  for (int face = 0; face < 6; ++face) {
    for (int y = 0; y < kCube; ++y) {
      for (int x = 0; x < kCube; ++x) {
        Eigen::Vector3d d;
        d[face / 2] = face % 2 == 0 ? 1 : -1;
        d[(face / 2 + 1) % 3] = (2 * x + 1.0) / kCube - 1;
        d[(face / 2 + 2) % 3] = (2 * y + 1.0) / kCube - 1;
        directions.push_back(d);
      }
    }
  }
  return directions;
}

Sphere MakeSphere(double exponent) {
  const std::vector<Eigen::Vector3d> directions = CubeDirections();
  Sphere sphere;
  for (int y = 0; y < kSize; ++y) {
    for (int x = 0; x < kSize; ++x) {
      const Eigen::Vector2d place((2 * x + 1.0) / kSize - 1, (2 * y + 1.0) / kSize - 1);
      if (place.norm() < 1) sphere.places.push_back(place);
    }
  }
  sphere.rows = MakeFunctionRows(static_cast<int64_t>(sphere.places.size()),
                                 static_cast<int>(directions.size()));
  for (size_t i = 0; i < sphere.places.size(); ++i) {
    const Eigen::Vector2d& p = sphere.places[i];
    const Eigen::Vector3d normal(p.x(), p.y(), std::sqrt(1 - p.squaredNorm()));
    const Eigen::Vector3d mirrored = 2 * normal.z() * normal - Eigen::Vector3d::UnitZ();
    for (size_t j = 0; j < directions.size(); ++j) {
      const double length = directions[j].norm();
      const double cosine = std::max(0.0, mirrored.dot(directions[j]) / length);
      // A texel's solid angle falls with the cube of its distance.
      sphere.rows.Row(static_cast<int64_t>(i))[j] =
          static_cast<float>(std::pow(cosine, exponent) / (length * length * length));
    }
  }
  return sphere;
}

// Extent along the circle round the middle over extent across it.
double Elongation(const std::vector<int64_t>& members, const Sphere& sphere) {
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();
  for (const int64_t row : members) mean += sphere.places[row];
  mean /= static_cast<double>(members.size());
  const Eigen::Vector2d out = mean.normalized(), along(-out.y(), out.x());
  double across_sum = 0, along_sum = 0;
  for (const int64_t row : members) {
    across_sum += std::pow((sphere.places[row] - mean).dot(out), 2);
    along_sum += std::pow((sphere.places[row] - mean).dot(along), 2);
  }
  return std::sqrt(along_sum / std::max(across_sum, 1e-12));
}

void WriteColours(const Clustering& clustering, const std::filesystem::path& png) {
  constexpr int kScale = 4;
  Image image(kSize * kScale, kSize * kScale, 3, PixelType::kUint8, ColorEncoding::kSrgb);
  std::vector<int> cluster(kSize * kSize, -1);
  size_t row = 0;
  for (int i = 0; i < kSize * kSize; ++i) {
    const Eigen::Vector2d place((2 * (i % kSize) + 1.0) / kSize - 1,
                                (2 * (i / kSize) + 1.0) / kSize - 1);
    if (place.norm() < 1) cluster[i] = clustering.cluster[row++];
  }
  for (int y = 0; y < image.height(); ++y) {
    for (int x = 0; x < image.width(); ++x) {
      const int c = cluster[y / kScale * kSize + x / kScale];
      for (int channel = 0; channel < 3; ++channel) {
        const uint32_t mixed = (static_cast<uint32_t>(c) + 1) * 2654435761u;
        image.At<uint8_t>(x, y, channel) =
            c < 0 ? 255 : static_cast<uint8_t>(60 + (mixed >> (8 * channel + 4) & 127));
      }
    }
  }
  WriteImage(image, png);
}

}  // namespace

void DrawPhongSphere(double exponent, int clusters, const std::filesystem::path& png) {
  constexpr double kRim = 0.9, kMiddle = 0.6;
  const Sphere sphere = MakeSphere(exponent);
  const Clustering found =
      ClusterRows(sphere.rows.View(), {.clusters = clusters, .terms = 4, .min_rows = 4});
  double sums[2] = {};
  int counts[2] = {};
  for (const std::vector<int64_t>& members : found.Members()) {
    double radius = 0;
    for (const int64_t row : members) radius += sphere.places[row].norm();
    radius /= static_cast<double>(members.size());
    if (radius > kMiddle && radius < kRim) continue;
    sums[radius >= kRim] += Elongation(members, sphere);
    ++counts[radius >= kRim];
  }
  std::printf(
      "\nFigure 8, Phong sphere, exponent %.0f, %d clusters: extent along the rim over extent "
      "across it: %.2f in the middle (%d clusters), %.2f at the rim (%d)\n",
      exponent, found.clusters, sums[0] / std::max(1, counts[0]), counts[0],
      sums[1] / std::max(1, counts[1]), counts[1]);
  WriteColours(found, png);
}

}  // namespace lfm::bench
