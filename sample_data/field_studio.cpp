// SPDX-License-Identifier: BSD-3-Clause
#include "sample_data/field_studio.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>

#include "core/error.h"
#include "core/parallel.h"
#include "core/ply.h"
#include "core/transport_matrix.h"
#include "sample_data/directional_response.h"
#include "sample_data/exports.h"
#include "sample_data/exposed_picture.h"
#include "sample_data/light_transport.h"
#include "sample_data/scene_mesh.h"
#include "sample_data/traced_photo.h"

namespace lfm {
namespace {

using V3d = Eigen::Vector3d;
using V3f = Eigen::Vector3f;

constexpr const char* kView = "view";
// What white paint that faces the light shows.
constexpr float kWhiteLevel = 0.8f;
constexpr int kHeldOutEvery = 8;
constexpr uint64_t kFieldStream = 0xf1e1d;
constexpr double kGoldenAngle = std::numbers::pi * 0.7639320225002102;  // (3 - sqrt 5) pi

std::vector<PathRay> PixelPaths(const Camera& camera, const Pose& camera_from_world, int x, int y,
                                int samples, uint64_t seed) {
  const Eigen::Matrix3d world_from_camera = camera_from_world.rotation.transpose();
  const V3f eye = camera_from_world.Center().cast<float>();
  const uint64_t pixel =
      static_cast<uint64_t>(y) * static_cast<uint64_t>(camera.width) + static_cast<uint64_t>(x);
  std::vector<PathRay> rays;
  for (int s = 0; s < samples; ++s) {
    const PathKey key{
        MakeSetKey(seed, kFieldStream, pixel << 16 | static_cast<uint64_t>(s / kSetSize)),
        static_cast<uint32_t>(s % kSetSize)};
    V3d place(x, y, 1);
    if (samples > 1) {
      const auto offset = RandomPair(key, 0xfffffffeu);
      place.x() += offset[0] - 0.5;
      place.y() += offset[1] - 0.5;
    }
    const V3d direction = world_from_camera * V3d((place.x() - camera.cx) / camera.fx,
                                                  (place.y() - camera.cy) / camera.fy, 1);
    rays.push_back({eye, direction.normalized().cast<float>(), key});
  }
  return rays;
}

// A triangle with each vertex, and which of its corners that is.
struct VertexPlace {
  int object = -1, triangle = -1, corner = 0;
};

std::vector<VertexPlace> PlacesOfVertices(const std::vector<SceneObject>& objects) {
  std::vector<VertexPlace> places;
  for (size_t o = 0; o < objects.size(); ++o) {
    const TriangleMesh& mesh = objects[o].mesh;
    const size_t first = places.size();
    places.resize(first + mesh.vertices.size());
    for (size_t t = 0; t < mesh.triangles.size(); ++t) {
      for (int c = 0; c < 3; ++c) {
        places[first + static_cast<size_t>(mesh.triangles[t][c])] = {static_cast<int>(o),
                                                                     static_cast<int>(t), c};
      }
    }
  }
  return places;
}

// RGB interleaved to the matrix's order: one channel after the other.
void StoreRow(const std::vector<float>& rgb, int channels, float* out) {
  const size_t texels = rgb.size() / 3;
  for (size_t t = 0; t < texels; ++t) {
    if (channels == 1) {
      out[t] = (rgb[3 * t] + rgb[3 * t + 1] + rgb[3 * t + 2]) / 3;
      continue;
    }
    for (size_t c = 0; c < 3; ++c) out[c * texels + t] = rgb[3 * t + c];
  }
}

// A dim room with a bright window, up to the left of the eye.
std::vector<float> PreviewLight(const CubeMap& cube) {
  std::vector<float> light;
  const V3f window = V3f(-0.5f, -0.5f, 0.7f).normalized();
  for (int t = 0; t < cube.Texels(); ++t) {
    const float cosine = cube.Direction(t).dot(window);
    light.push_back(0.25f + 3.5f * std::exp(12 * (cosine - 1)));
  }
  return light;
}

class FieldStudio {
 public:
  FieldStudio(const SceneDescription& scene, const StudioOptions& options,
              const std::filesystem::path& folder, Progress& progress)
      : scene_(scene),
        options_(options),
        folder_(folder),
        progress_(progress),
        traced_(scene.objects, {}, nullptr),
        seed_(static_cast<uint64_t>(options.seed)) {
    capture_.folder = folder;
    capture_.name = scene.name;
  }

  RayCounts Run() {
    std::error_code error;
    for (const char* earlier : {"capture.json", "preview.png", "mesh.ply", kMatrix}) {
      std::filesystem::remove(folder_ / earlier, error);
    }
    const TriangleMesh mesh = JoinObjects(scene_.objects);
    switch (scene_.kind) {
      case SceneKind::kReflectanceField:
        RecordReflectance();
        break;
      case SceneKind::kTransportImage:
        RecordTransportImage();
        break;
      case SceneKind::kTransportMesh:
        WritePly(mesh, folder_ / "mesh.ply");
        RecordTransportMesh(mesh.vertices.size());
        break;
      case SceneKind::kLightField:
        throw Error("scene '" + scene_.name + "' is a light field; it needs the platform");
    }
    Capture truth = capture_;
    truth.folder = folder_ / "ground_truth";
    WritePly(mesh, truth.folder / "mesh.ply");
    WriteExports(capture_, truth);
    SaveCapture(capture_);
    return rays_;
  }

 private:
  void ListCamera(const Camera& camera) {
    capture_.cameras[kView] = {camera.width, camera.height, camera, {}};
  }

  void RecordReflectance() {
    const Camera camera = FixedCamera(scene_.view);
    const Pose pose = FixedPose(scene_.view);
    const std::vector<V3f> lights = LightStageDirections(scene_.light_count);
    const DirectionalResponse response(
        traced_, lights, static_cast<float>(kWhiteLevel * std::numbers::pi), scene_.bounces);
    const PhotoFormat format = options_.trouble.photo.format;
    const Sensor sensor{options_.trouble.sensor.full_well_electrons,
                        options_.trouble.sensor.read_noise_electrons};
    std::vector<Image> pictures;
    for (size_t l = 0; l < lights.size(); ++l) {
      pictures.push_back(MakePicture(camera.width, camera.height, format));
    }
    progress_.Start("reflectance field", camera.height);
    std::vector<RayCounts> counts(static_cast<size_t>(camera.height));
    ParallelFor(0, camera.height, [&](int64_t row) {
      const int y = static_cast<int>(row);
      const size_t width = static_cast<size_t>(camera.width);
      std::vector<float> pixel(3 * lights.size());
      std::vector<float> rows(3 * lights.size() * width);
      for (int x = 0; x < camera.width; ++x) {
        const auto paths = PixelPaths(camera, pose, x, y, options_.SamplesPerPixel(4), seed_);
        std::fill(pixel.begin(), pixel.end(), 0.0f);
        counts[row] += response.Add(paths, 1 / static_cast<float>(paths.size()), pixel.data());
        for (size_t l = 0; l < lights.size(); ++l) {
          std::copy_n(&pixel[3 * l], 3, &rows[3 * (l * width + static_cast<size_t>(x))]);
        }
      }
      for (size_t l = 0; l < lights.size(); ++l) {
        const std::span<const float> values(&rows[3 * l * width], 3 * width);
        ExposePictureRow(sensor, values, seed_, l, y, pictures[l]);
      }
      progress_.Advance();
    });
    for (const RayCounts& c : counts) rays_ += c;
    WriteField(camera, pose, lights, pictures);
  }

  void WriteField(const Camera& camera, const Pose& pose, const std::vector<V3f>& lights,
                  const std::vector<Image>& pictures) {
    ReflectanceField field;
    field.camera = kView;
    field.camera_from_world = pose;
    field.encoding = ColorEncoding::kLinear;
    ImageWriteOptions write;
    write.png_compression = 1;
    if (options_.jpeg_quality > 0) write.jpeg_quality = options_.jpeg_quality;
    for (size_t l = 0; l < lights.size(); ++l) {
      char name[64];
      std::snprintf(name, sizeof(name), "fields/light_%03d", static_cast<int>(l));
      field.pictures.push_back(
          {name + PictureEnding(options_.trouble.photo.format),
           lights[l].cast<double>().normalized(),
           l % kHeldOutEvery == kHeldOutEvery / 2 ? PhotoSplit::kTest : PhotoSplit::kTrain});
    }
    ParallelFor(0, static_cast<int64_t>(lights.size()), [&](int64_t l) {
      WriteImage(pictures[l], folder_ / field.pictures[l].file, write);
    });
    ListCamera(camera);
    capture_.reflectance_field = std::move(field);
  }

  TransportOptions MakeTransportOptions() const {
    TransportOptions options;
    options.cube.resolution = scene_.cube_resolution;
    options.paths = options_.SamplesPerPixel(64);
    options.bounces = scene_.bounces;
    options.seed = seed_;
    return options;
  }

  // `fill_row(row, rgb)` adds to a zeroed row of texels x 3.
  template <typename FillRow>
  void RecordTransport(int64_t points, int64_t views, const FillRow& fill_row) {
    TransportShape shape;
    shape.points = points;
    shape.views = views;
    shape.cube_resolution = scene_.cube_resolution;
    shape.channels = options_.transport_channels;
    progress_.Start("light transport", shape.rows());
    const std::vector<float> window = PreviewLight({scene_.cube_resolution});
    preview_.resize(static_cast<size_t>(shape.rows()));
    WriteTransportMatrix(
        shape,
        [&](int64_t first, int64_t count, std::span<float> values) {
          std::vector<RayCounts> counts(static_cast<size_t>(count));
          ParallelFor(0, count, [&](int64_t r) {
            std::vector<float> rgb(3 * static_cast<size_t>(shape.columns()), 0.0f);
            counts[r] = fill_row(first + r, rgb.data());
            preview_[first + r] =
                Eigen::Map<const Eigen::Matrix3Xf>(rgb.data(), 3, shape.columns()) *
                Eigen::Map<const Eigen::VectorXf>(window.data(), shape.columns());
            StoreRow(rgb, shape.channels, &values[static_cast<size_t>(r * shape.row_values())]);
          });
          for (const RayCounts& c : counts) rays_ += c;
          progress_.Advance(count);
        },
        folder_ / kMatrix);
  }

  void RecordTransportImage() {
    const Camera camera = FixedCamera(scene_.view);
    const Pose pose = FixedPose(scene_.view);
    const TransportRow transport(traced_, MakeTransportOptions());
    RecordTransport(int64_t{camera.width} * camera.height, 1, [&](int64_t row, float* rgb) {
      RayCounts counts;
      const auto paths = PixelPaths(camera, pose, static_cast<int>(row % camera.width),
                                    static_cast<int>(row / camera.width), 1, seed_);
      transport.AddRay(paths[0].origin, paths[0].direction, static_cast<uint64_t>(row), 1, rgb,
                       &counts);
      return counts;
    });
    Image preview(camera.width, camera.height, 3, PixelType::kUint8, ColorEncoding::kSrgb);
    for (size_t i = 0; i < preview.size(); ++i) {
      preview.Data<uint8_t>()[i] = EncodeSrgb8(preview_[i / 3][static_cast<Eigen::Index>(i % 3)]);
    }
    WriteImage(preview, folder_ / "preview.png");
    ListCamera(camera);
    capture_.transport =
        TransportField{kMatrix, TransportKind::kImage, scene_.cube_resolution, kView, "", {}};
  }

  void RecordTransportMesh(size_t vertices) {
    const std::vector<VertexPlace> places = PlacesOfVertices(scene_.objects);
    const std::vector<V3d> eyes = ViewSphere(scene_.view, scene_.view_directions);
    const TransportRow transport(traced_, MakeTransportOptions());
    const auto points = static_cast<int64_t>(vertices);
    RecordTransport(points, static_cast<int64_t>(eyes.size()), [&](int64_t row, float* rgb) {
      const VertexPlace& place = places[row % points];
      if (place.object < 0) return RayCounts();
      const TriangleMesh& mesh = scene_.objects[place.object].mesh;
      const V3d& vertex = mesh.vertices[mesh.triangles[place.triangle][place.corner]];
      const V3f to_eye = (eyes[row / points] - vertex).normalized().cast<float>();
      // Seen from behind: nothing comes this way.
      if (TriangleNormal(mesh, place.triangle).cast<float>().dot(to_eye) <= 0) return RayCounts();
      // Just inside the triangle: at the corner itself neighbours would be in the way.
      constexpr float kInside = 1e-3f;
      float weights[3] = {kInside, kInside, kInside};
      weights[place.corner] = 1 - 2 * kInside;
      const SurfacePoint surface =
          traced_.SurfaceAt(place.object, place.triangle, weights[1], weights[2], to_eye);
      return transport.Add(surface, to_eye, static_cast<uint64_t>(row), 1, rgb);
    });
    capture_.transport =
        TransportField{kMatrix, TransportKind::kMesh, scene_.cube_resolution, "", "mesh.ply", eyes};
  }

  static constexpr const char* kMatrix = "transport.ltm";

  const SceneDescription& scene_;
  const StudioOptions& options_;
  std::filesystem::path folder_;
  Progress& progress_;
  TracedScene traced_;
  uint64_t seed_;
  Capture capture_;
  RayCounts rays_;
  std::vector<V3f> preview_;  // radiance of the rows under PreviewLight
};

}  // namespace

std::vector<V3f> LightStageDirections(int count) {
  if (count < 1) throw Error("a light stage needs at least one light");
  std::vector<V3f> directions;
  for (int i = 0; i < count; ++i) {
    const double z = 1 - (i + 0.5) / count, r = std::sqrt(1 - z * z), a = kGoldenAngle * i;
    directions.push_back(V3d(r * std::cos(a), r * std::sin(a), z).normalized().cast<float>());
  }
  return directions;
}

std::vector<V3d> ViewSphere(const FixedView& view, int count) {
  const V3d axis = view.eye - view.target;
  const double radius = axis.norm();
  if (!(radius > 0)) throw Error("the view's eye stands at its target");
  const Eigen::Quaterniond turn = Eigen::Quaterniond::FromTwoVectors(V3d::UnitZ(), axis);
  std::vector<V3d> eyes = {view.eye};
  for (int i = 1; i < count; ++i) {
    const double z = 1 - 2.0 * i / count, r = std::sqrt(std::max(0.0, 1 - z * z));
    const double a = kGoldenAngle * i;
    eyes.push_back(view.target + radius * (turn * V3d(r * std::cos(a), r * std::sin(a), z)));
  }
  return eyes;
}

SceneDescription ShrinkField(SceneDescription scene) {
  constexpr int kSide = 64, kLights = 24, kCube = 8, kViews = 4;
  const double scale =
      std::min(1.0, static_cast<double>(kSide) / std::max(scene.view.width, scene.view.height));
  const auto shrink = [&](int side) { return std::max(1, static_cast<int>(scale * side)); };
  scene.view.width = shrink(scene.view.width);
  scene.view.height = shrink(scene.view.height);
  scene.light_count = std::min(scene.light_count, kLights);
  scene.cube_resolution = std::min(scene.cube_resolution, kCube);
  scene.view_directions = std::min(scene.view_directions, kViews);
  return scene;
}

Camera FixedCamera(const FixedView& view) {
  if (view.width < 1 || view.height < 1 || view.width > 16384 || view.height > 16384) {
    throw Error("a view has 1 to 16384 pixels a side");
  }
  if (!(view.fov_deg > 0 && view.fov_deg < 170)) {
    throw Error("a view's field of view lies between 0 and 170 degrees");
  }
  Camera camera;
  camera.width = view.width;
  camera.height = view.height;
  camera.fx = camera.fy = 0.5 * view.width / std::tan(view.fov_deg * std::numbers::pi / 360);
  camera.cx = (view.width - 1) / 2.0;
  camera.cy = (view.height - 1) / 2.0;
  return camera;
}

Pose FixedPose(const FixedView& view) {
  if (!((view.eye - view.target).norm() > 0)) throw Error("the view's eye stands at its target");
  const V3d axis = (view.eye - view.target).normalized();
  return LookAt(view.eye, view.target, std::abs(axis.z()) < 0.999 ? V3d::UnitZ() : V3d::UnitY());
}

RayCounts MakeFieldCapture(const SceneDescription& scene, const StudioOptions& options,
                           const std::filesystem::path& folder, Progress& progress) {
  return FieldStudio(scene, options, folder, progress).Run();
}

}  // namespace lfm
