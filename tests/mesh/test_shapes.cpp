// SPDX-License-Identifier: BSD-3-Clause
#include "tests/mesh/test_shapes.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <random>
#include <utility>

#include "core/error.h"
#include "mesh/surface_distance.h"

namespace lfm::test {
namespace {

constexpr std::array<std::array<int, 3>, 20> kIcosahedron = {
    {{0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
     {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
     {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}}};

TriangleMesh SplitInFour(const TriangleMesh& mesh) {
  TriangleMesh result;
  result.vertices = mesh.vertices;
  std::map<std::pair<int, int>, int> middles;
  const auto middle = [&](int a, int b) {
    const auto key = std::minmax(a, b);
    const auto [place, is_new] = middles.try_emplace(key, static_cast<int>(result.vertices.size()));
    if (is_new) result.vertices.push_back(0.5 * (mesh.vertices[a] + mesh.vertices[b]));
    return place->second;
  };
  for (const Eigen::Vector3i& t : mesh.triangles) {
    const int ab = middle(t[0], t[1]), bc = middle(t[1], t[2]), ca = middle(t[2], t[0]);
    result.triangles.emplace_back(t[0], ab, ca);
    result.triangles.emplace_back(ab, t[1], bc);
    result.triangles.emplace_back(ca, bc, t[2]);
    result.triangles.emplace_back(ab, bc, ca);
  }
  return result;
}

}  // namespace

TriangleMesh MakeSphere(double radius, int splits, const Eigen::Vector3d& center) {
  const double g = std::numbers::phi;
  TriangleMesh mesh;
  mesh.vertices = {{-1, g, 0},  {1, g, 0},  {-1, -g, 0}, {1, -g, 0}, {0, -1, g},  {0, 1, g},
                   {0, -1, -g}, {0, 1, -g}, {g, 0, -1},  {g, 0, 1},  {-g, 0, -1}, {-g, 0, 1}};
  for (const auto& t : kIcosahedron) mesh.triangles.emplace_back(t[0], t[1], t[2]);
  for (int i = 0; i < splits; ++i) mesh = SplitInFour(mesh);
  for (Eigen::Vector3d& v : mesh.vertices) v = center + radius * v.normalized();
  return mesh;
}

TriangleMesh MakeTorus(double ring, double tube, double height, int around, int across) {
  TriangleMesh mesh;
  for (int i = 0; i < around; ++i) {
    for (int j = 0; j < across; ++j) {
      const double u = 2 * std::numbers::pi * i / around, v = 2 * std::numbers::pi * j / across;
      const double r = ring + tube * std::cos(v);
      mesh.vertices.emplace_back(r * std::cos(u), r * std::sin(u), height + tube * std::sin(v));
      const int i1 = (i + 1) % around, j1 = (j + 1) % across;
      mesh.triangles.emplace_back(i * across + j, i1 * across + j, i1 * across + j1);
      mesh.triangles.emplace_back(i * across + j, i1 * across + j1, i * across + j1);
    }
  }
  return mesh;
}

TriangleMesh MakeSquare(double side, double height, int cells) {
  TriangleMesh mesh;
  for (int y = 0; y <= cells; ++y) {
    for (int x = 0; x <= cells; ++x) {
      mesh.vertices.emplace_back(side * (static_cast<double>(x) / cells - 0.5),
                                 side * (static_cast<double>(y) / cells - 0.5), height);
      if (x == cells || y == cells) continue;
      const int a = y * (cells + 1) + x, b = a + cells + 1;
      mesh.triangles.emplace_back(a, a + 1, b + 1);
      mesh.triangles.emplace_back(a, b + 1, b);
    }
  }
  return mesh;
}

TriangleMesh MakeBox(const Eigen::Vector3d& low, const Eigen::Vector3d& high, int cells) {
  TriangleMesh mesh;
  std::map<std::array<int, 3>, int> index;
  const auto vertex = [&](const Eigen::Vector3i& c) {
    const auto [place, is_new] =
        index.try_emplace({c[0], c[1], c[2]}, static_cast<int>(mesh.vertices.size()));
    if (is_new) {
      mesh.vertices.push_back(low + (high - low).cwiseProduct(c.cast<double>() / cells));
    }
    return place->second;
  };
  for (int axis = 0; axis < 3; ++axis) {
    for (int side = 0; side < 2; ++side) {
      for (int i = 0; i < cells; ++i) {
        for (int j = 0; j < cells; ++j) {
          Eigen::Vector3i corner[4];
          for (int k = 0; k < 4; ++k) {
            corner[k][axis] = side * cells;
            corner[k][(axis + 1) % 3] = i + (k == 1 || k == 2);
            corner[k][(axis + 2) % 3] = j + (k >= 2);
          }
          if (side == 0) std::swap(corner[1], corner[3]);
          mesh.triangles.emplace_back(vertex(corner[0]), vertex(corner[1]), vertex(corner[2]));
          mesh.triangles.emplace_back(vertex(corner[0]), vertex(corner[2]), vertex(corner[3]));
        }
      }
    }
  }
  return mesh;
}

PointCloud MeasureCloud(const TriangleMesh& mesh, int count, const CloudNoise& noise) {
  const SurfaceSamples samples = SampleSurface(mesh, count, noise.seed);
  const std::vector<Eigen::Vector3d> vertex_normals = ComputeVertexNormals(mesh);
  std::mt19937 random(noise.seed);
  std::normal_distribution<double> normal_distribution;
  PointCloud cloud;
  for (size_t i = 0; i < samples.points.size(); ++i) {
    const double error = noise.along_normal_mm * normal_distribution(random);
    const Eigen::Vector3d& n = samples.normals[i];
    if (n.z() < noise.hidden_below_normal_z || samples.points[i].z() < noise.hidden_below_mm) {
      continue;
    }
    cloud.points.push_back(samples.points[i] + error * n);
    cloud.normals.push_back(n);
    cloud.confidence.push_back(0.5f + 0.5f * static_cast<float>(i % 7) / 7);
  }
  return cloud;
}

void AddPlatform(PointCloud& cloud, int count, double half_side_mm, double free_radius_mm,
                 double noise_mm, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> place(-half_side_mm, half_side_mm);
  std::normal_distribution<double> height(0, noise_mm);
  for (int i = 0; i < count; ++i) {
    const Eigen::Vector3d p(place(random), place(random), height(random));
    if (p.head<2>().norm() < free_radius_mm) continue;
    cloud.points.push_back(p);
    cloud.normals.push_back(Eigen::Vector3d::UnitZ());
    cloud.confidence.push_back(1);
  }
}

void AddOutliers(PointCloud& cloud, int count, double half_side_mm, double height_mm,
                 unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> place(-1, 1);
  for (int i = 0; i < count; ++i) {
    const double x = place(random), y = place(random), z = place(random);
    cloud.points.emplace_back(half_side_mm * x, half_side_mm * y, height_mm * (0.5 + 0.5 * z));
    cloud.normals.push_back(Eigen::Vector3d(y, z, x).normalized());
    cloud.confidence.push_back(0.3f);
  }
}

void Append(PointCloud& cloud, const PointCloud& other) {
  cloud.points.insert(cloud.points.end(), other.points.begin(), other.points.end());
  cloud.normals.insert(cloud.normals.end(), other.normals.begin(), other.normals.end());
  cloud.confidence.insert(cloud.confidence.end(), other.confidence.begin(), other.confidence.end());
}

PointCloud MakeBumpyBall(int64_t count) {
  PointCloud cloud;
  cloud.points.reserve(count);
  cloud.normals.reserve(count);
  cloud.confidence.assign(count, 1);
  uint64_t state = 1;
  for (int64_t i = 0; i < count; ++i) {
    const double z = 1 - 2 * (static_cast<double>(i) + 0.5) / static_cast<double>(count);
    const double turn = std::numbers::pi * (3 - std::sqrt(5.0)) * static_cast<double>(i);
    const double r = std::sqrt(1 - z * z);
    const Eigen::Vector3d out(r * std::cos(turn), r * std::sin(turn), z);
    state = state * 6364136223846793005ULL + 1442695040888963407ULL;
    const double noise = static_cast<double>(state >> 40) * 0x1.0p-24 - 0.5;
    const double radius = 40 + 0.5 * std::sin(9 * out.x()) * std::sin(9 * out.y()) + 0.2 * noise;
    cloud.points.push_back(radius * out + Eigen::Vector3d(0, 0, 39));
    cloud.normals.push_back(out);
  }
  return cloud;
}

CalibResult MakeCalib(int count, double distance_mm, double height_mm) {
  CalibResult calib;
  Camera camera;
  camera.width = 960;
  camera.height = 720;
  camera.fx = camera.fy = 1700;
  camera.cx = 479.5;
  camera.cy = 359.5;
  calib.cameras["camera"] = camera;
  const Eigen::Vector3d target(0, 0, height_mm);
  for (int i = 0; i < count; ++i) {
    const double azimuth = 2.4 * i, elevation = 0.2 + 1.0 * i / count;
    const Eigen::Vector3d direction(std::cos(elevation) * std::cos(azimuth),
                                    std::cos(elevation) * std::sin(azimuth), std::sin(elevation));
    PosedImage photo;
    photo.id = "photo_" + std::to_string(i);
    photo.file = photo.id + ".png";
    photo.camera = "camera";
    photo.camera_from_world =
        LookAt(target + distance_mm * direction, target, Eigen::Vector3d::UnitZ());
    calib.photos.push_back(photo);
  }
  return calib;
}

std::vector<double> SmallestAngles(const TriangleMesh& mesh) {
  std::vector<double> angles;
  for (const Eigen::Vector3i& t : mesh.triangles) {
    double smallest = std::numbers::pi;
    for (int k = 0; k < 3; ++k) {
      const Eigen::Vector3d u = mesh.vertices[t[(k + 1) % 3]] - mesh.vertices[t[k]];
      const Eigen::Vector3d v = mesh.vertices[t[(k + 2) % 3]] - mesh.vertices[t[k]];
      smallest = std::min(smallest, std::atan2(u.cross(v).norm(), u.dot(v)));
    }
    angles.push_back(smallest * 180 / std::numbers::pi);
  }
  std::sort(angles.begin(), angles.end());
  return angles;
}

double TotalArea(const TriangleMesh& mesh) {
  double area = 0;
  for (size_t t = 0; t < mesh.triangles.size(); ++t)
    area += TriangleArea(mesh, static_cast<int>(t));
  return area;
}

bool IsClosedManifold(const TriangleMesh& mesh) {
  const MeshTopology topology = ExamineTopology(mesh);
  return topology.closed && topology.manifold;
}

std::string ErrorOf(const std::function<void()>& action) {
  try {
    action();
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

}  // namespace lfm::test
