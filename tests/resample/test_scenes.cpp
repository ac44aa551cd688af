// SPDX-License-Identifier: BSD-3-Clause
#include "test_scenes.h"

#include <cmath>
#include <numbers>
#include <stdexcept>
#include <utility>

#include "core/parallel.h"
#include "core/ray_scene.h"

namespace lfm::test {
namespace {

TriangleMesh Icosahedron() {
  const double g = std::numbers::phi;
  TriangleMesh mesh;
  mesh.vertices = {{-1, g, 0},  {1, g, 0},  {-1, -g, 0}, {1, -g, 0}, {0, -1, g},  {0, 1, g},
                   {0, -1, -g}, {0, 1, -g}, {g, 0, -1},  {g, 0, 1},  {-g, 0, -1}, {-g, 0, 1}};
  mesh.triangles = {{0, 11, 5}, {0, 5, 1},  {0, 1, 7},   {0, 7, 10}, {0, 10, 11},
                    {1, 5, 9},  {5, 11, 4}, {11, 10, 2}, {10, 7, 6}, {7, 1, 8},
                    {3, 9, 4},  {3, 4, 2},  {3, 2, 6},   {3, 6, 8},  {3, 8, 9},
                    {4, 9, 5},  {2, 4, 11}, {6, 2, 10},  {8, 6, 7},  {9, 8, 1}};
  return mesh;
}

TriangleMesh Subdivide(const TriangleMesh& mesh) {
  TriangleMesh finer;
  finer.vertices = mesh.vertices;
  std::map<std::pair<int, int>, int> middles;
  const auto middle = [&](int a, int b) {
    const auto key = std::minmax(a, b);
    const auto [place, is_new] = middles.try_emplace(key, static_cast<int>(finer.vertices.size()));
    if (is_new) finer.vertices.push_back((finer.vertices[a] + finer.vertices[b]) / 2);
    return place->second;
  };
  for (const Eigen::Vector3i& t : mesh.triangles) {
    const int ab = middle(t[0], t[1]), bc = middle(t[1], t[2]), ca = middle(t[2], t[0]);
    finer.triangles.insert(finer.triangles.end(),
                           {{t[0], ab, ca}, {ab, t[1], bc}, {ca, bc, t[2]}, {ab, bc, ca}});
  }
  return finer;
}

}  // namespace

TriangleMesh Sphere(const Eigen::Vector3d& center, double radius, int subdivisions) {
  TriangleMesh mesh = Icosahedron();
  for (int i = 0; i < subdivisions; ++i) mesh = Subdivide(mesh);
  for (Eigen::Vector3d& vertex : mesh.vertices) {
    mesh.normals.push_back(vertex.normalized());
    vertex = center + radius * mesh.normals.back();
  }
  return mesh;
}

TriangleMesh Torus(double ring_radius, double tube_radius, int around, int across) {
  TriangleMesh mesh;
  for (int i = 0; i < around; ++i) {
    const double u = 2 * std::numbers::pi * i / around;
    const Eigen::Vector3d outwards(std::cos(u), std::sin(u), 0);
    for (int j = 0; j < across; ++j) {
      const double v = 2 * std::numbers::pi * j / across;
      mesh.normals.push_back(std::cos(v) * outwards + std::sin(v) * Eigen::Vector3d::UnitZ());
      mesh.vertices.push_back(ring_radius * outwards + tube_radius * mesh.normals.back());
      const auto index = [&](int a, int b) { return a % around * across + b % across; };
      mesh.triangles.emplace_back(index(i, j), index(i + 1, j), index(i + 1, j + 1));
      mesh.triangles.emplace_back(index(i, j), index(i + 1, j + 1), index(i, j + 1));
    }
  }
  return mesh;
}

TriangleMesh Join(const TriangleMesh& a, const TriangleMesh& b) {
  TriangleMesh joined = a;
  const auto offset = static_cast<int>(a.vertices.size());
  joined.vertices.insert(joined.vertices.end(), b.vertices.begin(), b.vertices.end());
  joined.normals.insert(joined.normals.end(), b.normals.begin(), b.normals.end());
  for (const Eigen::Vector3i& t : b.triangles) {
    joined.triangles.push_back(t + Eigen::Vector3i::Constant(offset));
  }
  return joined;
}

Camera TestCamera(int width, int height, double focal_px) {
  Camera camera;
  camera.width = width;
  camera.height = height;
  camera.fx = focal_px;
  camera.fy = 1.01 * focal_px;
  camera.cx = 0.5 * width + 3;
  camera.cy = 0.5 * height - 2;
  camera.k1 = -0.08;
  camera.k2 = 0.02;
  camera.p1 = 0.001;
  camera.p2 = -0.0007;
  return camera;
}

std::vector<Pose> PosesAround(int count, double distance) {
  std::vector<Pose> poses;
  for (int i = 0; i < count; ++i) {
    const double azimuth = 2.399963 * i;  // the golden angle
    const double elevation = (15 + 65 * (i + 0.5) / count) * std::numbers::pi / 180;
    const Eigen::Vector3d eye(std::cos(elevation) * std::cos(azimuth),
                              std::cos(elevation) * std::sin(azimuth), std::sin(elevation));
    poses.push_back(LookAt(distance * eye, {0, 0, 0}, {0, 0, 1}));
  }
  return poses;
}

Image RenderPhoto(const TriangleMesh& mesh, const Camera& camera, const Pose& camera_from_world,
                  const ColorOf& color, const Eigen::Vector3d& background, int samples) {
  const RayScene scene(mesh);
  const Pose world_from_camera = camera_from_world.Inverse();
  Image picture(camera.width, camera.height, 3, PixelType::kUint8, ColorEncoding::kSrgb);
  ParallelFor(0, camera.height, [&](int64_t row) {
    const int y = static_cast<int>(row);
    for (int x = 0; x < camera.width; ++x) {
      Eigen::Vector3d sum = Eigen::Vector3d::Zero();
      for (int s = 0; s < samples * samples; ++s) {
        const Eigen::Vector2d pixel(x - 0.5 + (s % samples + 0.5) / samples,
                                    y - 0.5 + (s / samples + 0.5) / samples);
        const Eigen::Vector3d ray = world_from_camera.rotation * Unproject(camera, pixel);
        const auto hit = scene.Intersect(world_from_camera.translation, ray);
        sum += hit ? color(world_from_camera.translation + hit->distance * ray) : background;
      }
      sum /= samples * samples;
      for (int c = 0; c < 3; ++c) {
        picture.At<uint8_t>(x, y, c) =
            static_cast<uint8_t>(std::lround(255 * std::min(1.0, std::max(0.0, sum[c]))));
      }
    }
  });
  return picture;
}

ImageLoader MemoryCapture::Loader() const {
  return [this](const std::string& file) { return pictures.at(file); };
}

MemoryCapture MakeCapture(const TriangleMesh& mesh, const Camera& camera,
                          const std::vector<Pose>& poses, const ColorOf& color,
                          const Eigen::Vector3d& background, int samples) {
  MemoryCapture made;
  made.calib.cameras["camera"] = camera;
  made.capture.cameras["camera"] = {camera.width, camera.height, camera};
  for (size_t i = 0; i < poses.size(); ++i) {
    Photo photo;
    photo.id = "photo" + std::to_string(i);
    photo.file = photo.id + ".png";
    photo.camera = "camera";
    PosedImage posed;
    posed.id = photo.id;
    posed.camera = photo.camera;
    posed.file = photo.file;
    posed.camera_from_world = poses[i];
    made.pictures[photo.file] = RenderPhoto(mesh, camera, poses[i], color, background, samples);
    made.capture.photos.push_back(photo);
    made.calib.photos.push_back(posed);
  }
  return made;
}

std::filesystem::path TestFolder(const std::string& name) {
  const std::filesystem::path folder =
      std::filesystem::temp_directory_path() / ("lfm_resample_" + name);
  std::filesystem::remove_all(folder);
  std::filesystem::create_directories(folder);
  return folder;
}

}  // namespace lfm::test
