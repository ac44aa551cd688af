// SPDX-License-Identifier: BSD-3-Clause
#include "sample_data/traced_photo.h"

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "core/parallel.h"

namespace lfm {
namespace {

using V3f = Eigen::Vector3f;

constexpr int kTile = 8, kTilePixels = kTile * kTile;
constexpr int kSamplesAtOnce = 16;
constexpr uint32_t kPixelPair = 0xffffffffu - 1;  // beyond every surface's

class PhotoTile {
 public:
  PhotoTile(const PathTracer& tracer, const PixelRays& rays, const Pose& camera_from_world,
            const TraceOptions& options, int samples, int set_size)
      : tracer_(tracer),
        rays_(rays),
        options_(options),
        samples_(samples),
        set_size_(set_size),
        world_from_camera_(camera_from_world.rotation.transpose().cast<float>()),
        eye_(camera_from_world.Center().cast<float>()) {}

  RayCounts Render(int x0, int y0, TracedPhoto& photo) const {
    const Camera& camera = rays_.camera();
    const int columns = std::min(kTile, camera.width - x0);
    const int rows = std::min(kTile, camera.height - y0), pixels = columns * rows;
    V3f sum[kTilePixels], squares[kTilePixels], set[kTilePixels];
    for (int p = 0; p < pixels; ++p) sum[p] = squares[p] = set[p] = V3f::Zero();
    std::vector<PathRay> batch;
    std::vector<V3f> radiance;
    RayCounts counts;
    for (int first = 0; first < samples_; first += kSamplesAtOnce) {
      const int now = std::min(kSamplesAtOnce, samples_ - first);
      batch.clear();
      for (int p = 0; p < pixels; ++p) {
        for (int s = first; s < first + now; ++s) {
          batch.push_back(Ray(x0 + p % columns, y0 + p / columns, s));
        }
      }
      radiance.resize(batch.size());
      counts += tracer_.Trace(batch, radiance);
      for (int p = 0; p < pixels; ++p) {
        for (int s = 0; s < now; ++s) {
          set[p] += radiance[static_cast<size_t>(p) * now + s];
          if ((first + s + 1) % set_size_ != 0) continue;
          sum[p] += set[p];
          squares[p] += set[p].cwiseAbs2();
          set[p].setZero();
        }
      }
    }
    const float sets = static_cast<float>(samples_ / set_size_);
    for (int p = 0; p < pixels; ++p) {
      const int x = x0 + p % columns, y = y0 + p / columns;
      const V3f mean = sum[p] / static_cast<float>(samples_);
      const V3f spread =
          (squares[p] - sum[p].cwiseAbs2() / sets).cwiseMax(0.0f) / std::max(1.0f, sets - 1);
      const V3f error = (spread / sets).cwiseSqrt() / static_cast<float>(set_size_);
      for (int c = 0; c < 3; ++c) {
        photo.radiance.At<float>(x, y, c) = mean[c];
        photo.standard_error.At<float>(x, y, c) = error[c];
      }
    }
    MarkObjects(x0, y0, columns, rows, photo.mask);
    return counts;
  }

 private:
  V3f Direction(int x, int y, float dx, float dy) const {
    return (world_from_camera_ * rays_.Direction(x, y, dx, dy)).normalized();
  }

  PathRay Ray(int x, int y, int sample) const {
    const uint64_t pixel = static_cast<uint64_t>(y) * rays_.camera().width + x;
    const uint64_t set = pixel << 20 | static_cast<uint64_t>(sample / kSetSize);
    const PathKey key{MakeSetKey(options_.seed, options_.picture, set),
                      static_cast<uint32_t>(sample % kSetSize)};
    const auto place = RandomPair(key, kPixelPair);
    return {eye_, Direction(x, y, place[0] - 0.5f, place[1] - 0.5f), key};
  }

  void MarkObjects(int x0, int y0, int columns, int rows, Image& mask) const {
    for (int y = y0; y < y0 + rows; ++y) {
      RayPacket packet;
      for (int i = 0; i < columns; ++i) {
        packet.Set(i, eye_, Direction(x0 + i, y, 0, 0), 0, 1e9f);
      }
      tracer_.scene().Intersect(packet, RayOrder::kCoherent);
      for (int i = 0; i < columns; ++i) {
        const unsigned id = packet.rays.hit.geomID[i];
        const bool object = id != RTC_INVALID_GEOMETRY_ID && tracer_.scene().IsObject(id);
        mask.At<uint8_t>(x0 + i, y) = object ? 255 : 0;
      }
    }
  }

  const PathTracer& tracer_;
  const PixelRays& rays_;
  const TraceOptions& options_;
  int samples_, set_size_;
  Eigen::Matrix3f world_from_camera_;
  V3f eye_;
};

}  // namespace

TracedPhoto TracePhoto(const PathTracer& tracer, const PixelRays& rays,
                       const Pose& camera_from_world, const TraceOptions& options) {
  if (options.samples_per_pixel < 1 || options.samples_per_pixel > 65536) {
    throw Error("samples per pixel is " + std::to_string(options.samples_per_pixel) +
                "; give a number from 1 to 65536");
  }
  const int asked = options.samples_per_pixel;
  const int samples = asked > 4 ? (asked + kSetSize - 1) / kSetSize * kSetSize : asked;
  const int set_size = samples > 4 ? kSetSize : 1;
  const Camera& camera = rays.camera();
  TracedPhoto photo;
  photo.radiance =
      Image(camera.width, camera.height, 3, PixelType::kFloat32, ColorEncoding::kLinear);
  photo.standard_error = photo.radiance;
  photo.mask = Image(camera.width, camera.height, 1, PixelType::kUint8, ColorEncoding::kSrgb);
  const PhotoTile tile(tracer, rays, camera_from_world, options, samples, set_size);
  const int across = (camera.width + kTile - 1) / kTile, down = (camera.height + kTile - 1) / kTile;
  std::vector<RayCounts> counts(static_cast<size_t>(across) * down);
  ParallelFor(0, static_cast<int64_t>(counts.size()), [&](int64_t t) {
    counts[t] = tile.Render(static_cast<int>(t % across) * kTile,
                            static_cast<int>(t / across) * kTile, photo);
  });
  for (const RayCounts& count : counts) photo.rays += count;
  return photo;
}

}  // namespace lfm
