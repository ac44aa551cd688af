// SPDX-License-Identifier: BSD-3-Clause
#include "sample_data/scan_renderer.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/parallel.h"
#include "sample_data/random.h"

namespace lfm {
namespace {

using V3f = Eigen::Vector3f;

constexpr float kPi = std::numbers::pi_v<float>;
constexpr float kFar = 1e5f;
constexpr float kOffsetMm = 0.02f;
// Sixteen points of a pixel, seen across the stripes: the spans of neighbours overlap by half.
constexpr double kSpansAcrossPixel = 8;

double Fraction(double x) { return x - std::floor(x); }

struct SurfacePoint {
  bool valid = false;
  V3f point = V3f::Zero(), normal = V3f::Zero();
  float albedo = 0;
  bool bounces = false;  // bright enough to pass light on
};

class ScanTracer {
 public:
  ScanTracer(const ScanSubject& subject, const ScanRig& rig, const PixelRays& rays,
             const Pose& camera_from_world, const PatternTable& patterns,
             const ScanExposure& exposure, uint64_t seed, uint64_t picture)
      : subject_(subject),
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

  // sums: patterns.frames() values, in slot order, linear.
  void TracePixel(int x, int y, float* sums) const {
    RayPacket packet;
    for (int s = 0; s < kFineSamples; ++s) {
      const float* offset = kFinePattern[s];
      packet.Set(s, eye_, world_from_camera_ * rays_.Direction(x, y, offset[0], offset[1]), 0,
                 kFar);
    }
    subject_.scene->Intersect(packet, RayOrder::kCoherent);
    SurfacePoint first[kFineSamples];
    bool any = false, gathers = false;
    for (int s = 0; s < kFineSamples; ++s) {
      first[s] = Resolve(packet, s);
      any |= first[s].valid;
      gathers |= first[s].bounces;
    }
    if (!any) return;
    const float share = static_cast<float>(exposure_.white * kPi / kPaintAlbedo) / kFineSamples;
    float factor[kFineSamples];
    for (int s = 0; s < kFineSamples; ++s) factor[s] = share * first[s].albedo / kPi;
    AddProjected(first, factor, RayOrder::kCoherent, sums);
    float ambient = 0;
    if (gathers) {
      ambient = AddBounce(x, y, first, share, sums);
    } else {
      for (const SurfacePoint& p : first) ambient += p.albedo / kFineSamples;
    }
    const float level = static_cast<float>(exposure_.ambient / kPaintAlbedo) * ambient;
    for (int f = 0; f < patterns_.frames(); ++f) sums[f] += level;
  }

 private:
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
      p.bounces = true;
    } else {
      const Patch& patch = subject_.scene->patches()[hit.patch];
      p.normal = patch.Normal().cast<float>();
      p.albedo = subject_.reflectance->Albedo(patch.material, p.point);
      p.bounces = patch.material != PatchMaterial::kTable;
    }
    return p;
  }

  // Adds the projector's light on each point, times `factor`; hidden points get none. The points
  // of one pixel stand for stretches of the pattern as long as their spacing, so that the edges of
  // stripes come out smooth; scattered ones (of a bounce) stand for themselves.
  void AddProjected(const SurfacePoint* points, const float* factor, RayOrder order,
                    float* sums) const {
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
    }
    subject_.scene->Occlude(packet);
    const Eigen::Vector2d width = order == RayOrder::kCoherent
                                      ? Eigen::Vector2d((high - low) / kSpansAcrossPixel)
                                      : Eigen::Vector2d(0, 0);
    for (int s = 0; s < kFineSamples; ++s) {
      if (!(weights[s] > 0) || StudioScene::Blocked(packet, s)) continue;
      patterns_.Accumulate({MakeSpan(pixels[s].x(), width.x(), projector_.width),
                            MakeSpan(pixels[s].y(), width.y(), projector_.height), weights[s]},
                           sums);
    }
  }

  // One cosine-distributed ray a sample. Returns the mean of albedo times the share of the room
  // seen.
  float AddBounce(int x, int y, const SurfacePoint* first, float share, float* sums) const {
    RandomStream random(seed_, picture_,
                        static_cast<uint64_t>(y) * static_cast<uint64_t>(rays_.camera().width) + x);
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
    AddProjected(second, factor, RayOrder::kScattered, sums);
    return ambient;
  }

  const ScanSubject& subject_;
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

PatternTable::PatternTable(const PatternSequence& sequence)
    : frames_(static_cast<int>(sequence.patterns.size())) {
  std::vector<int> rows;
  for (int f = 0; f < frames_; ++f) {
    const Pattern& pattern = sequence.patterns[f];
    const bool constant =
        pattern.kind == PatternKind::kWhite || pattern.kind == PatternKind::kBlack;
    (pattern.axis == PatternAxis::kRow && !constant ? rows : frame_of_slot_).push_back(f);
  }
  column_slots_ = static_cast<int>(frame_of_slot_.size());
  row_slots_ = static_cast<int>(rows.size());
  by_column_.resize(static_cast<size_t>(sequence.projector_width) * column_slots_);
  by_row_.resize(static_cast<size_t>(sequence.projector_height) * row_slots_);
  for (int column = 0; column < sequence.projector_width; ++column) {
    for (int i = 0; i < column_slots_; ++i) {
      by_column_[static_cast<size_t>(column) * column_slots_ + i] = static_cast<float>(
          PatternValue(sequence, sequence.patterns[frame_of_slot_[i]], column, 0));
    }
  }
  for (int row = 0; row < sequence.projector_height; ++row) {
    for (int i = 0; i < row_slots_; ++i) {
      by_row_[static_cast<size_t>(row) * row_slots_ + i] =
          static_cast<float>(PatternValue(sequence, sequence.patterns[rows[i]], 0, row));
    }
  }
  frame_of_slot_.insert(frame_of_slot_.end(), rows.begin(), rows.end());
}

void PatternTable::AddSpan(const std::vector<float>& table, int slots, const ProjectedSpan& span,
                           float weight, float* sums) {
  const float* values = table.data() + static_cast<size_t>(span.index) * slots;
  const float first = weight * (1 - span.share);
  for (int i = 0; i < slots; ++i) sums[i] += first * values[i];
  if (span.share <= 0) return;
  const float second = weight * span.share;
  values += slots;
  for (int i = 0; i < slots; ++i) sums[i] += second * values[i];
}

void PatternTable::Accumulate(const ProjectedSample& sample, float* sums) const {
  AddSpan(by_column_, column_slots_, sample.column, sample.weight, sums);
  AddSpan(by_row_, row_slots_, sample.row, sample.weight, sums + column_slots_);
}

ProjectedSpan MakeSpan(double center, double width, int count) {
  const double half = 0.5 * std::clamp(width, 1e-6, 1.0);
  // In the frame where pixel i covers [i, i + 1).
  const double low = std::clamp(center + 0.5 - half, 0.0, count - 1e-9);
  const double high = std::clamp(center + 0.5 + half, low, count - 1e-9);
  ProjectedSpan span;
  span.index = static_cast<int>(low);
  if (static_cast<int>(high) > span.index) {
    span.share = static_cast<float>((high - static_cast<int>(high)) / (high - low));
  }
  return span;
}

std::vector<Image> RenderScan(const ScanSubject& subject, const ScanRig& rig, const PixelRays& rays,
                              const Pose& camera_from_world, const PatternTable& patterns,
                              const ScanExposure& exposure, const Sensor& sensor, uint64_t seed,
                              uint64_t picture) {
  const Camera& camera = rays.camera();
  std::vector<Image> frames;
  for (int f = 0; f < patterns.frames(); ++f) {
    frames.emplace_back(camera.width, camera.height, 1, PixelType::kUint8, ColorEncoding::kSrgb);
  }
  const ScanTracer tracer(subject, rig, rays, camera_from_world, patterns, exposure, seed, picture);
  ParallelFor(0, camera.height, [&](int64_t y) {
    std::vector<float> rows(static_cast<size_t>(patterns.frames()) * camera.width, 0.0f);
    std::vector<float> sums(patterns.frames());
    for (int x = 0; x < camera.width; ++x) {
      std::fill(sums.begin(), sums.end(), 0.0f);
      tracer.TracePixel(x, static_cast<int>(y), sums.data());
      for (int slot = 0; slot < patterns.frames(); ++slot) {
        rows[static_cast<size_t>(patterns.frame_of_slot()[slot]) * camera.width + x] = sums[slot];
      }
    }
    for (int f = 0; f < patterns.frames(); ++f) {
      const uint64_t stream = (picture << 16) + static_cast<uint64_t>(f) + 1;
      ExposeRow(sensor, &rows[static_cast<size_t>(f) * camera.width], camera.width, seed, stream,
                static_cast<uint64_t>(y), &frames[f].At<uint8_t>(0, static_cast<int>(y)));
    }
  });
  return frames;
}

}  // namespace lfm
