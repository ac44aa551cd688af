// SPDX-License-Identifier: BSD-3-Clause
#include "sample_data/field_studio.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <numbers>

#include "core/error.h"
#include "core/parallel.h"
#include "core/ply.h"
#include "core/transport_matrix.h"
#include "sample_data/directional_response.h"
#include "sample_data/exports.h"
#include "sample_data/exposed_picture.h"
#include "sample_data/light_transport.h"
#include "sample_data/random.h"
#include "sample_data/scene_mesh.h"
#include "sample_data/studio_report.h"
#include "sample_data/transport_preview.h"

namespace lfm {
namespace {

using V3d = Eigen::Vector3d;
using V3f = Eigen::Vector3f;

constexpr const char* kView = "view";
// What white paint that faces the light shows.
constexpr float kWhiteLevel = 0.8f;
// The most that one path of few may bring of bounced light: what two surfaces of middling albedo
// give. Fireflies of caustics end here, and what is above it of caustics.
constexpr float kIndirectLimit = kWhiteLevel / 4;
constexpr int kHeldOutEvery = 8;
constexpr uint64_t kFieldStream = 0xf1e1d;
// Rows whose noise is measured: traced again with other random numbers.
constexpr int kNoisePictureRows = 16, kNoiseMatrixRows = 64;
constexpr uint64_t kAgain = 0xa6a1;

bool IsNoiseRow(int64_t row, int64_t rows, int step) {
  return row % step == std::min<int64_t>(step, rows) / 2;
}

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

class FieldStudio {
 public:
  FieldStudio(const SceneDescription& scene, const StudioOptions& options,
              const std::filesystem::path& folder, Progress& progress)
      : scene_(scene),
        options_(options),
        folder_(folder),
        progress_(progress),
        traced_(scene.objects, {}, nullptr),
        seed_(static_cast<uint64_t>(options.seed)),
        seed_again_(ScrambleBits(seed_ ^ kAgain)) {
    capture_.folder = folder;
    capture_.name = scene.name;
  }

  StageReport Run() {
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
    WriteStudioReport(options_, {report_}, truth.folder / "studio.json");
    NoteReport({report_}, progress_);
    SaveCapture(capture_);
    return report_;
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
        traced_, lights, static_cast<float>(kWhiteLevel * std::numbers::pi), scene_.bounces,
        options_.quality == RenderQuality::kReference ? std::numeric_limits<float>::infinity()
                                                      : kIndirectLimit);
    const PhotoFormat format = options_.trouble.photo.format;
    const Sensor sensor = MakeSensor(options_);
    std::vector<Image> pictures;
    for (size_t l = 0; l < lights.size(); ++l) {
      pictures.push_back(MakePicture(camera.width, camera.height, format));
    }
    report_.name = "reflectance field";
    progress_.Start(report_.name, camera.height);
    const StageClock clock;
    std::vector<RayCounts> counts(static_cast<size_t>(camera.height));
    std::vector<NoiseTally> noise(static_cast<size_t>(camera.height));
    ParallelFor(0, camera.height, [&](int64_t row) {
      const int y = static_cast<int>(row);
      const size_t width = static_cast<size_t>(camera.width);
      std::vector<float> pixel(3 * lights.size());
      std::vector<float> rows(3 * lights.size() * width);
      for (int x = 0; x < camera.width; ++x) {
        const auto trace = [&](uint64_t seed, std::vector<float>& values) {
          const auto paths = PixelPaths(camera, pose, x, y, options_.SamplesPerPixel(4), seed);
          std::fill(values.begin(), values.end(), 0.0f);
          return response.Add(paths, 1 / static_cast<float>(paths.size()), values.data());
        };
        counts[row] += trace(seed_, pixel);
        if (IsNoiseRow(row, camera.height, kNoisePictureRows)) {
          std::vector<float> again(pixel.size());
          counts[row] += trace(seed_again_, again);
          noise[row] += TallyPair(pixel, again, &sensor);
        }
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
    for (const RayCounts& c : counts) report_.rays += c;
    report_.noise = NoiseTally();
    for (const NoiseTally& n : noise) *report_.noise += n;
    clock.Stop(report_);
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

  static NoiseTally TallyPair(const std::vector<float>& once, const std::vector<float>& again,
                              const Sensor* sensor) {
    NoiseTally noise;
    for (size_t i = 0; i < once.size(); ++i) {
      const double difference = static_cast<double>(once[i]) - again[i];
      const double variance = difference * difference / 2;
      sensor == nullptr ? noise.Add(once[i], variance) : noise.Add(once[i], variance, *sensor);
    }
    return noise;
  }

  TransportOptions MakeTransportOptions(uint64_t seed) const {
    TransportOptions options;
    options.cube.resolution = scene_.cube_resolution;
    options.paths = options_.SamplesPerPixel(64);
    options.bounces = scene_.bounces;
    options.seed = seed;
    return options;
  }

  // `fill_row(row, seed, rgb)` adds to a zeroed row of texels x 3; seed: the usual or the other.
  template <typename FillRow>
  void RecordTransport(int64_t points, int64_t views, const FillRow& fill_row) {
    TransportShape shape;
    shape.points = points;
    shape.views = views;
    shape.cube_resolution = scene_.cube_resolution;
    shape.channels = options_.transport_channels;
    report_.name = "light transport";
    report_.has_sensor = false;
    report_.noise = NoiseTally();
    const StageClock clock;
    progress_.Start(report_.name, shape.rows());
    const std::vector<float> window = PreviewLight({scene_.cube_resolution});
    preview_.resize(static_cast<size_t>(shape.rows()));
    WriteTransportMatrix(
        shape,
        [&](int64_t first, int64_t count, std::span<float> values) {
          std::vector<RayCounts> counts(static_cast<size_t>(count));
          std::vector<NoiseTally> noise(static_cast<size_t>(count));
          ParallelFor(0, count, [&](int64_t r) {
            std::vector<float> rgb(3 * static_cast<size_t>(shape.columns()), 0.0f);
            counts[r] = fill_row(first + r, Seed::kUsual, rgb.data());
            if (IsNoiseRow(first + r, shape.rows(), kNoiseMatrixRows)) {
              std::vector<float> again(rgb.size(), 0.0f);
              counts[r] += fill_row(first + r, Seed::kOther, again.data());
              noise[r] = TallyPair(rgb, again, nullptr);
            }
            preview_[first + r] =
                Eigen::Map<const Eigen::Matrix3Xf>(rgb.data(), 3, shape.columns()) *
                Eigen::Map<const Eigen::VectorXf>(window.data(), shape.columns());
            StoreRow(rgb, shape.channels, &values[static_cast<size_t>(r * shape.row_values())]);
          });
          for (const RayCounts& c : counts) report_.rays += c;
          for (const NoiseTally& n : noise) *report_.noise += n;
          progress_.Advance(count);
        },
        folder_ / kMatrix);
    clock.Stop(report_);
  }

  void RecordTransportImage() {
    const Camera camera = FixedCamera(scene_.view);
    const Pose pose = FixedPose(scene_.view);
    const TransportRow usual(traced_, MakeTransportOptions(seed_));
    const TransportRow other(traced_, MakeTransportOptions(seed_again_));
    const int64_t pixels = int64_t{camera.width} * camera.height;
    RecordTransport(pixels, 1, [&](int64_t row, Seed seed, float* rgb) {
      RayCounts counts;
      const auto paths = PixelPaths(camera, pose, static_cast<int>(row % camera.width),
                                    static_cast<int>(row / camera.width), 1, seed_);
      (seed == Seed::kUsual ? usual : other)
          .AddRay(paths[0].origin, paths[0].direction, static_cast<uint64_t>(row), 1, rgb, &counts);
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
    const TransportRow usual(traced_, MakeTransportOptions(seed_));
    const TransportRow other(traced_, MakeTransportOptions(seed_again_));
    const auto points = static_cast<int64_t>(vertices);
    const auto views = static_cast<int64_t>(eyes.size());
    RecordTransport(points, views, [&](int64_t row, Seed seed, float* rgb) {
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
      return (seed == Seed::kUsual ? usual : other)
          .Add(surface, to_eye, static_cast<uint64_t>(row), 1, rgb);
    });
    // The first view's rows come first.
    preview_.resize(vertices);
    WriteImage(PreviewMesh(traced_, scene_.view, preview_), folder_ / "preview.png");
    capture_.transport =
        TransportField{kMatrix, TransportKind::kMesh, scene_.cube_resolution, "", "mesh.ply", eyes};
  }

  enum class Seed { kUsual, kOther };
  static constexpr const char* kMatrix = "transport.ltm";

  const SceneDescription& scene_;
  const StudioOptions& options_;
  std::filesystem::path folder_;
  Progress& progress_;
  TracedScene traced_;
  uint64_t seed_, seed_again_;
  Capture capture_;
  StageReport report_;
  std::vector<V3f> preview_;  // radiance of the rows under PreviewLight
};

}  // namespace

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

StageReport MakeFieldCapture(const SceneDescription& scene, const StudioOptions& options,
                             const std::filesystem::path& folder, Progress& progress) {
  return FieldStudio(scene, options, folder, progress).Run();
}

}  // namespace lfm
