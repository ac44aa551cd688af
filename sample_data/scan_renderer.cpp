// SPDX-License-Identifier: BSD-3-Clause
#include "sample_data/scan_renderer.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/parallel.h"
#include "sample_data/print_sampler.h"
#include "sample_data/random.h"
#include "sample_data/scan_bounce.h"

namespace lfm {
namespace {

using V3f = Eigen::Vector3f;

constexpr float kPi = std::numbers::pi_v<float>;
constexpr float kFar = 1e5f;
constexpr float kOffsetMm = 0.02f;
// Sixteen points of a pixel, seen across the stripes: the spans of neighbours overlap by half.
constexpr double kSpansAcrossPixel = 8;
constexpr int kEdgeRays = 8;
// Squared length of the mean of normals that still count as one: halves of a pixel
// that differ by less than 26 degrees.
constexpr float kOneNormal2 = 0.95f;
constexpr int kBandRows = 64;

double Fraction(double x) { return x - std::floor(x); }

struct SurfacePoint {
  bool valid = false;
  V3f point = V3f::Zero(), normal = V3f::Zero();
  float albedo = 0;
  bool bounces = false;  // bright enough to pass light on
  bool spreads = false;  // light inside itself
};

class ScanTracer {
 public:
  ScanTracer(const ScanSubject& subject, const ScanRig& rig, const PixelRays& rays,
             const Pose& camera_from_world, const PatternTable& patterns,
             const ScanExposure& exposure, uint64_t seed, uint64_t picture)
      : subject_(subject),
        print_(*subject.reflectance, rays, camera_from_world),
        rays_(rays),
        patterns_(patterns),
        exposure_(exposure),
        seed_(seed),
        picture_(picture),
        projector_(rig.projector),
        projector_from_world_(rig.projector_from_camera * camera_from_world),
        world_from_camera_(camera_from_world.rotation.transpose().cast<float>()),
        eye_(camera_from_world.Center().cast<float>()),
        lamp_(projector_from_world_.Center().cast<float>()) {}

  // Traces a row of the band; frames in slot order.
  void TraceRow(int y, ScanBand& band, RayCounts& counts) const {
    for (int x = 0; x < band.width; ++x) {
      TracePixel(x, y, band.Direct(x, y), band.Bounce(x, y), band.Guide(x, y), counts);
    }
  }

 private:
  void TracePixel(int x, int y, float* direct, float* bounce, ScanGuide& guide,
                  RayCounts& counts) const {
    RayPacket packet;
    for (int s = 0; s < kFineSamples; ++s) {
      const float* offset = kFinePattern[s];
      packet.Set(s, eye_, world_from_camera_ * rays_.Direction(x, y, offset[0], offset[1]), 0,
                 kFar);
    }
    subject_.scene->Intersect(packet, RayOrder::kCoherent);
    counts.camera += kFineSamples;
    SurfacePoint first[kFineSamples];
    bool any = false, gathers = false;
    guide.whole = true;
    for (int s = 0; s < kFineSamples; ++s) first[s] = Resolve(packet, s);
    IntegratePrint(packet, x, y, first);
    for (int s = 0; s < kFineSamples; ++s) {
      any |= first[s].valid;
      gathers |= first[s].bounces;
      guide.whole &= first[s].bounces;
      guide.point += first[s].point / kFineSamples;
      guide.normal += first[s].normal / kFineSamples;
      guide.albedo += first[s].albedo / kFineSamples;
    }
    if (!any) return;
    // A crease is an edge, too: there is no one normal.
    guide.whole &= guide.normal.squaredNorm() > kOneNormal2;
    if (guide.whole) guide.normal.normalize();
    const float share = static_cast<float>(exposure_.white * kPi / kPaintAlbedo) / kFineSamples;
    float factor[kFineSamples];
    for (int s = 0; s < kFineSamples; ++s) factor[s] = share * first[s].albedo / kPi;
    AddProjected(first, factor, RayOrder::kCoherent, direct, counts);
    const float ambient_light = static_cast<float>(exposure_.ambient / kPaintAlbedo);
    if (!gathers) {
      for (int f = 0; f < patterns_.frames(); ++f) direct[f] += ambient_light * guide.albedo;
      return;
    }
    RandomStream random(seed_, picture_,
                        static_cast<uint64_t>(y) * static_cast<uint64_t>(rays_.camera().width) + x);
    // Edges are not filtered: they take more rays.
    const int bounce_rays = exposure_.bounce_rays * (guide.whole ? 1 : kEdgeRays);
    const float part = 1 / static_cast<float>(bounce_rays);
    float ambient = 0;
    for (int ray = 0; ray < bounce_rays; ++ray) {
      ambient += part * AddBounce(random, first, part * share, bounce, counts);
    }
    for (int f = 0; f < patterns_.frames(); ++f) bounce[f] += ambient_light * ambient;
  }

  SurfacePoint Resolve(const RayPacket& packet, int lane) const {
    SurfacePoint p;
    const SurfaceHit hit = StudioScene::Hit(packet, lane);
    if (hit.triangle < 0 && hit.patch < 0) return p;
    const RTCRay16& ray = packet.rays.ray;
    const V3f direction(ray.dir_x[lane], ray.dir_y[lane], ray.dir_z[lane]);
    p.valid = true;
    p.point = V3f(ray.org_x[lane], ray.org_y[lane], ray.org_z[lane]) + hit.distance * direction;
    if (hit.triangle >= 0) {
      const Eigen::Vector3i& t = subject_.mesh->triangles[hit.triangle];
      const auto& n = subject_.mesh->normals;
      p.normal = ((1 - hit.u - hit.v) * n[t[0]] + hit.u * n[t[1]] + hit.v * n[t[2]])
                     .normalized()
                     .cast<float>();
      p.albedo = static_cast<float>(kPaintAlbedo);
      p.bounces = p.spreads = true;
    } else {
      const Patch& patch = subject_.scene->patches()[hit.patch];
      p.normal = patch.Normal().cast<float>();
      p.albedo = subject_.reflectance->Albedo(patch, p.point);
      p.bounces = patch.material != PatchMaterial::kTable;
    }
    return p;
  }

  // Albedo of the cells of a pixel that holds a print edge, for that of their points.
  void IntegratePrint(const RayPacket& packet, int x, int y, SurfacePoint* points) const {
    const Patch* prints[kFineSamples] = {};
    bool varies = false;
    for (int s = 0; s < kFineSamples; ++s) {
      const int hit = StudioScene::Hit(packet, s).patch;
      if (hit < 0) continue;
      const Patch& patch = subject_.scene->patches()[hit];
      if (patch.material != PatchMaterial::kPrint) continue;
      prints[s] = &patch;
      varies |= points[s].albedo != points[0].albedo;
    }
    if (!varies && (prints[0] == nullptr || !print_.CornersDiffer(*prints[0], x, y))) return;
    for (int s = 0; s < kFineSamples; ++s) {
      if (prints[s] != nullptr) points[s].albedo = Luminance(print_.CellColor(*prints[s], x, y, s));
    }
  }

  // Adds the projector's light on each point, times `factor`; hidden points get none. The points
  // of one pixel stand for stretches of the pattern as long as their spacing, so that the edges of
  // stripes come out smooth; scattered ones (of a bounce) stand for themselves.
  void AddProjected(const SurfacePoint* points, const float* factor, RayOrder order, float* sums,
                    RayCounts& counts) const {
    RayPacket packet;
    Eigen::Vector2d pixels[kFineSamples];
    float weights[kFineSamples] = {};
    Eigen::Vector2d low(1e9, 1e9), high(-1e9, -1e9);
    for (int s = 0; s < kFineSamples; ++s) {
      if (!points[s].valid || !(factor[s] > 0)) continue;
      const V3f origin = points[s].point + kOffsetMm * points[s].normal;
      const V3f to_lamp = lamp_ - origin;
      const float facing = points[s].normal.dot(to_lamp);
      if (facing <= 0) continue;
      const Eigen::Vector3d p = projector_from_world_ * points[s].point.cast<double>();
      const auto pixel = Project(projector_, p);
      if (!pixel || !projector_.Contains(*pixel)) continue;
      pixels[s] = *pixel;
      low = low.cwiseMin(*pixel);
      high = high.cwiseMax(*pixel);
      // Every projector pixel sends the same flux: even light on a screen across the axis.
      const float depth = static_cast<float>(p.z());
      const float near = static_cast<float>(kNearMm) / depth;
      weights[s] = factor[s] * near * near * facing / depth;
      packet.Set(s, origin, to_lamp, 0, 0.999f);
      ++counts.shadow;
    }
    subject_.scene->Occlude(packet);
    const Eigen::Vector2d width = order == RayOrder::kCoherent
                                      ? Eigen::Vector2d((high - low) / kSpansAcrossPixel)
                                      : Eigen::Vector2d(0, 0);
    for (int s = 0; s < kFineSamples; ++s) {
      if (!(weights[s] > 0) || StudioScene::Blocked(packet, s)) continue;
      Show(points[s], pixels[s], width, weights[s], sums);
    }
  }

  // Adds what the projector shows around `pixel`.
  void Show(const SurfacePoint& point, const Eigen::Vector2d& pixel, const Eigen::Vector2d& width,
            float weight, float* sums) const {
    if (exposure_.subsurface_mm <= 0 || !point.spreads) {
      patterns_.Accumulate({patterns_.ColumnSpan(pixel.x(), width.x()),
                            patterns_.RowSpan(pixel.y(), width.y()), weight},
                           sums);
      return;
    }
    // A Gaussian in the tangent plane is one along each of the projector's axes; columns and rows
    // are looked up apart, so both may be stepped through together.
    const Eigen::Vector2d sigma = exposure_.subsurface_mm * PixelsPerMm(point);
    constexpr double kReach = 3.5;  // sigmas
    const int steps = std::clamp(static_cast<int>(2 * kReach * sigma.maxCoeff()), 14, 256);
    double total = 0;
    for (int i = 0; i <= steps; ++i) total += GaussianStep(i, steps, kReach);
    for (int i = 0; i <= steps; ++i) {
      const double offset = kReach * (2.0 * i / steps - 1);
      const Eigen::Vector2d spacing = (2 * kReach / steps) * sigma;
      patterns_.Accumulate(
          {patterns_.ColumnSpan(pixel.x() + offset * sigma.x(), std::max(width.x(), spacing.x())),
           patterns_.RowSpan(pixel.y() + offset * sigma.y(), std::max(width.y(), spacing.y())),
           weight * static_cast<float>(GaussianStep(i, steps, kReach) / total)},
          sums);
    }
  }

  static double GaussianStep(int i, int steps, double reach) {
    const double offset = reach * (2.0 * i / steps - 1);
    return std::exp(-0.5 * offset * offset);
  }

  // How far the projector's column, and row, move at most for a step of 1 mm on the surface.
  Eigen::Vector2d PixelsPerMm(const SurfacePoint& point) const {
    constexpr float kStepMm = 0.05f;
    const V3f& n = point.normal;
    const V3f helper = std::abs(n.z()) < 0.9f ? V3f(0, 0, 1) : V3f(1, 0, 0);
    const V3f t = helper.cross(n).normalized(), b = n.cross(t);
    Eigen::Vector2d squares(0, 0);
    for (const V3f& axis : {t, b}) {
      const auto ahead = Project(
          projector_, projector_from_world_ * (point.point + kStepMm * axis).cast<double>());
      const auto behind = Project(
          projector_, projector_from_world_ * (point.point - kStepMm * axis).cast<double>());
      if (!ahead || !behind) continue;
      squares += ((*ahead - *behind) / (2 * kStepMm)).cwiseAbs2();
    }
    return squares.cwiseSqrt();
  }

  // One cosine-distributed ray a sample. Returns the mean of albedo times the share of the room
  // seen.
  float AddBounce(RandomStream& random, const SurfacePoint* first, float share, float* sums,
                  RayCounts& counts) const {
    const double shift1 = random.Uniform(), shift2 = random.Uniform();
    RayPacket packet;
    for (int s = 0; s < kFineSamples; ++s) {
      if (!first[s].valid) continue;
      const double u1 = Fraction((s * 7 % kFineSamples + shift1) / kFineSamples);
      const double u2 = Fraction(s * 0.6180339887498949 + shift2);
      const float radius = static_cast<float>(std::sqrt(u1));
      const float angle = 2 * kPi * static_cast<float>(u2);
      const V3f& n = first[s].normal;
      const V3f helper = std::abs(n.z()) < 0.9f ? V3f(0, 0, 1) : V3f(1, 0, 0);
      const V3f t = helper.cross(n).normalized(), b = n.cross(t);
      const V3f direction = radius * std::cos(angle) * t + radius * std::sin(angle) * b +
                            std::sqrt(std::max(0.0f, 1 - radius * radius)) * n;
      packet.Set(s, first[s].point + kOffsetMm * n, direction, 0, kFar);
      ++counts.bounce;
    }
    subject_.scene->Intersect(packet, RayOrder::kScattered);
    SurfacePoint second[kFineSamples];
    float factor[kFineSamples] = {};
    float ambient = 0;
    for (int s = 0; s < kFineSamples; ++s) {
      if (!first[s].valid) continue;
      second[s] = Resolve(packet, s);
      if (!second[s].valid) {
        ambient += first[s].albedo / kFineSamples;
        continue;
      }
      ambient += 0.5f * first[s].albedo * second[s].albedo / kFineSamples;
      factor[s] = share * first[s].albedo * second[s].albedo / kPi;
    }
    AddProjected(second, factor, RayOrder::kScattered, sums, counts);
    return ambient;
  }

  const ScanSubject& subject_;
  PrintSampler print_;
  const PixelRays& rays_;
  const PatternTable& patterns_;
  const ScanExposure& exposure_;
  uint64_t seed_, picture_;
  const Camera& projector_;
  Pose projector_from_world_;
  Eigen::Matrix3f world_from_camera_;
  V3f eye_, lamp_;
};

}  // namespace

ScanExposure MakeScanExposure(const ScanTrouble& trouble) {
  ScanExposure exposure;
  exposure.white *= trouble.exposure_factor;
  exposure.ambient = trouble.ambient_light * trouble.exposure_factor;
  exposure.subsurface_mm = trouble.subsurface_mm;
  return exposure;
}

namespace {

// Adds up the light of a row's pixels, and exposes it in every frame.
void ExposeScanRow(const ScanBand& band, int y, const PatternTable& patterns, const Sensor& sensor,
                   uint64_t seed, uint64_t picture, std::vector<Image>& frames) {
  const int width = band.width;
  std::vector<float> rows(static_cast<size_t>(patterns.frames()) * width);
  std::vector<float> sums(patterns.frames());
  for (int x = 0; x < width; ++x) {
    AddFilteredBounce(band, x, y, sums.data());
    for (int slot = 0; slot < patterns.frames(); ++slot) {
      rows[static_cast<size_t>(patterns.frame_of_slot()[slot]) * width + x] = sums[slot];
    }
  }
  for (int f = 0; f < patterns.frames(); ++f) {
    const uint64_t stream = (picture << 16) + static_cast<uint64_t>(f) + 1;
    ExposeRow(sensor, &rows[static_cast<size_t>(f) * width], width, seed, stream,
              static_cast<uint64_t>(y), &frames[f].At<uint8_t>(0, y));
  }
}

}  // namespace

ScanFrames RenderScan(const ScanSubject& subject, const ScanRig& rig, const PixelRays& rays,
                      const Pose& camera_from_world, const PatternTable& patterns,
                      const ScanExposure& exposure, const Sensor& sensor, uint64_t seed,
                      uint64_t picture) {
  const Camera& camera = rays.camera();
  ScanFrames result;
  std::vector<Image>& frames = result.pictures;
  for (int f = 0; f < patterns.frames(); ++f) {
    frames.emplace_back(camera.width, camera.height, 1, PixelType::kUint8, ColorEncoding::kSrgb);
  }
  const ScanTracer tracer(subject, rig, rays, camera_from_world, patterns, exposure, seed, picture);
  std::vector<RayCounts> counts(static_cast<size_t>(camera.height));
  // A part of the rows at a time: all frames of a large picture would not fit into memory.
  ScanBand band(camera.width, 0, 0, patterns.frames());
  int traced = 0;
  for (int begin = 0; begin < camera.height; begin += kBandRows) {
    const int end = std::min(begin + kBandRows, camera.height);
    const int top = std::max(0, begin - kBounceReach);
    const int bottom = std::min(camera.height, end + kBounceReach);
    ScanBand next(camera.width, top, bottom - top, patterns.frames());
    next.CopyRows(band);
    ParallelFor(traced, bottom,
                [&](int64_t y) { tracer.TraceRow(static_cast<int>(y), next, counts[y]); });
    traced = bottom;
    band = std::move(next);
    ParallelFor(begin, end, [&](int64_t y) {
      ExposeScanRow(band, static_cast<int>(y), patterns, sensor, seed, picture, frames);
    });
  }
  for (const RayCounts& count : counts) result.rays += count;
  return result;
}

ScanNoise MeasureScanNoise(const ScanSubject& subject, const ScanRig& rig, const PixelRays& rays,
                           const Pose& camera_from_world, const PatternTable& patterns,
                           const ScanExposure& exposure, const Sensor& sensor, uint64_t seed,
                           uint64_t picture, int row_step) {
  constexpr uint64_t kAgain = 0x5ca2;
  const Camera& camera = rays.camera();
  const ScanTracer once(subject, rig, rays, camera_from_world, patterns, exposure, seed, picture);
  const ScanTracer again(subject, rig, rays, camera_from_world, patterns, exposure,
                         ScrambleBits(seed ^ kAgain), picture);
  const int first = std::min(row_step, camera.height) / 2;
  std::vector<ScanNoise> parts(
      static_cast<size_t>((camera.height - first + row_step - 1) / row_step));
  ParallelFor(0, static_cast<int64_t>(parts.size()), [&](int64_t i) {
    const int y = first + static_cast<int>(i) * row_step;
    const int top = std::max(0, y - kBounceReach);
    const int rows = std::min(camera.height - 1, y + kBounceReach) - top + 1;
    ScanBand a(camera.width, top, rows, patterns.frames()), b = a;
    for (int row = top; row < top + rows; ++row) {
      once.TraceRow(row, a, parts[i].rays);
      again.TraceRow(row, b, parts[i].rays);
    }
    std::vector<float> one(patterns.frames()), other(patterns.frames());
    for (int x = 0; x < camera.width; ++x) {
      AddFilteredBounce(a, x, y, one.data());
      AddFilteredBounce(b, x, y, other.data());
      for (int f = 0; f < patterns.frames(); ++f) {
        const double difference = static_cast<double>(one[f]) - other[f];
        parts[i].noise.Add(one[f], difference * difference / 2, sensor);
      }
    }
  });
  ScanNoise sum;
  for (const ScanNoise& part : parts) {
    sum.noise += part.noise;
    sum.rays += part.rays;
  }
  return sum;
}

}  // namespace lfm
