// SPDX-License-Identifier: BSD-3-Clause
#include "sample_data/occluder.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/parallel.h"

namespace lfm {
namespace {

using V3 = Eigen::Vector3d;
using V3f = Eigen::Vector3f;

// The nearer root of |p + t d|^2 = r^2 for orthogonal coordinates (a, b, c of the quadratic).
std::optional<double> NearRoot(double a, double b, double c) {
  const double discriminant = b * b - a * c;
  if (!(a > 0) || discriminant < 0) return std::nullopt;
  return (-b - std::sqrt(discriminant)) / a;
}

class OccluderTracer {
 public:
  OccluderTracer(const Occluder& occluder, const Lighting& lighting, const PixelRays& rays,
                 const Pose& camera_from_world)
      : occluder_(occluder),
        lighting_(lighting),
        rays_(rays),
        world_from_camera_(camera_from_world.rotation.transpose()),
        eye_(camera_from_world.Center()) {
    const Camera& camera = rays.camera();
    pixel_ = 1 / std::min(camera.fx, camera.fy);
  }

  void MaskRow(int y, Image& mask) const {
    for (int x = 0; x < rays_.camera().width; ++x) {
      if (First(Direction(x, y, 0, 0))) mask.At<uint8_t>(x, y) = 0;
    }
  }

  void CoverRow(int y, RenderedPhoto& photo) const {
    for (int x = 0; x < rays_.camera().width; ++x) {
      const V3 middle = Direction(x, y, 0, 0);
      if (!PassesNear(middle)) continue;
      if (First(middle)) photo.mask.At<uint8_t>(x, y) = 0;
      V3f sum = V3f::Zero();
      int covered = 0;
      for (const auto& offset : kFinePattern) {
        const V3 direction = Direction(x, y, offset[0], offset[1]);
        const auto hit = First(direction);
        if (!hit) continue;
        sum += Shade(eye_ + hit->distance * direction, hit->normal);
        ++covered;
      }
      const float share = static_cast<float>(covered) / kFineSamples;
      float* out = &photo.radiance.At<float>(x, y);
      for (int c = 0; c < 3; ++c) out[c] = (1 - share) * out[c] + sum[c] / kFineSamples;
    }
  }

 private:
  V3 Direction(int x, int y, float dx, float dy) const {
    return world_from_camera_ * rays_.Direction(x, y, dx, dy).cast<double>();
  }

  std::optional<CapsuleHit> First(const V3& direction) const {
    std::optional<CapsuleHit> first;
    for (const Capsule& capsule : occluder_.capsules) {
      const auto hit = IntersectCapsule(capsule, eye_, direction);
      if (hit && (!first || hit->distance < first->distance)) first = hit;
    }
    return first;
  }

  // Whether any ray of the pixel may meet a capsule: one grown by two pixels' width is met.
  bool PassesNear(const V3& direction) const {
    return std::any_of(
        occluder_.capsules.begin(), occluder_.capsules.end(), [&](const Capsule& capsule) {
          Capsule grown = capsule;
          const double far = std::max((capsule.a - eye_).norm(), (capsule.b - eye_).norm());
          grown.radius += 2 * pixel_ * far;
          return IntersectCapsule(grown, eye_, direction).has_value();
        });
  }

  V3f Shade(const V3& point, const V3& normal) const {
    constexpr float kPi = std::numbers::pi_v<float>;
    V3f irradiance = kPi * lighting_.Environment(normal.cast<float>());
    for (const AreaLight& lamp : lighting_.lights) {
      for (int i = 0; i < kLightCells; ++i) {
        const V3 to = lamp.Point((i % kLightCellsPerSide + 0.5) / kLightCellsPerSide,
                                 (i / kLightCellsPerSide + 0.5) / kLightCellsPerSide) -
                      point;
        const double d2 = to.squaredNorm();
        const double here = normal.dot(to), there = -lamp.Normal().dot(to);
        if (here <= 0 || there <= 0) continue;
        irradiance += static_cast<float>(here * there / (d2 * d2) * lamp.Area() / kLightCells) *
                      lamp.radiance;
      }
    }
    return occluder_.albedo.cwiseProduct(irradiance) / kPi;
  }

  const Occluder& occluder_;
  const Lighting& lighting_;
  const PixelRays& rays_;
  Eigen::Matrix3d world_from_camera_;
  V3 eye_;
  double pixel_ = 0;
};

// A ball's rings from pole to pole, drawn apart along the axis between the two middle rings.
void AppendCapsule(const Capsule& capsule, TriangleMesh& mesh) {
  constexpr int kSides = 64, kRings = 16;  // rings of either half
  constexpr double kPi = std::numbers::pi;
  const V3 along = capsule.b - capsule.a;
  const V3 z = along.norm() > 0 ? V3(along.normalized()) : V3(V3::UnitZ());
  const V3 x = z.unitOrthogonal(), y = z.cross(x);
  const int first = static_cast<int>(mesh.vertices.size());
  const int rings = 2 * kRings + 2;
  for (int ring = 0; ring < rings; ++ring) {
    const bool far_half = ring > kRings;
    const double polar = kPi / 2 * (far_half ? ring - 1 : ring) / kRings - kPi / 2;
    for (int side = 0; side < kSides; ++side) {
      const double angle = 2 * kPi * side / kSides;
      const V3 n =
          std::cos(polar) * (std::cos(angle) * x + std::sin(angle) * y) + std::sin(polar) * z;
      mesh.normals.push_back(n);
      mesh.vertices.push_back((far_half ? capsule.b : capsule.a) + capsule.radius * n);
    }
  }
  const auto corner = [&](int ring, int side) { return first + ring * kSides + side % kSides; };
  for (int ring = 0; ring + 1 < rings; ++ring) {
    if (ring == kRings && along.isZero(0)) continue;  // a ball: both middle rings are its equator
    for (int side = 0; side < kSides; ++side) {
      const int a = corner(ring, side), b = corner(ring, side + 1);
      const int c = corner(ring + 1, side + 1), d = corner(ring + 1, side);
      // At the poles one of the two has no area.
      if (ring > 0) mesh.triangles.emplace_back(a, b, c);
      if (ring + 2 < rings) mesh.triangles.emplace_back(a, c, d);
    }
  }
}

// A hand in its own frame: x towards the fingertips, y across, z out of its back; its middle
// fingertip at the origin, mm.
std::vector<Capsule> HandCapsules() {
  std::vector<Capsule> hand;
  const auto add = [&](const V3& a, const V3& b, double radius) { hand.push_back({a, b, radius}); };
  constexpr double kFingerLength[4] = {66, 78, 72, 56};
  for (int finger = 0; finger < 4; ++finger) {
    const double y = (finger - 1.5) * 19;
    const double knuckle = -86 - 4 * std::abs(finger - 1.2);
    const double spread = 0.09 * (finger - 1.5);
    const V3 root(knuckle, y, 0);
    const V3 joint =
        root + 0.55 * kFingerLength[finger] * V3(std::cos(spread), std::sin(spread), 0);
    const V3 tip = joint + 0.45 * kFingerLength[finger] * V3(0.94, std::sin(spread), -0.30);
    add(root, joint, 8.6);
    add(joint, tip, 7.6);
    add(root, V3(-165, 0.62 * y, 2), 13);  // the palm
  }
  add(V3(-135, -34, -4), V3(-96, -58, -12), 10.5);  // the thumb
  add(V3(-96, -58, -12), V3(-68, -62, -16), 9.5);
  add(V3(-170, 0, 2), V3(-480, 0, 10), 29);  // the forearm
  return hand;
}

}  // namespace

std::optional<CapsuleHit> IntersectCapsule(const Capsule& capsule, const V3& origin,
                                           const V3& direction) {
  const double length = direction.norm();
  const V3 d = direction / length;
  const V3 axis = capsule.b - capsule.a, from_a = origin - capsule.a;
  const double r2 = capsule.radius * capsule.radius, axis2 = axis.squaredNorm();
  if (axis2 > 0) {
    // Perpendicular to the axis, its side is a circle.
    const V3 d_across = d - d.dot(axis) / axis2 * axis;
    const V3 o_across = from_a - from_a.dot(axis) / axis2 * axis;
    const auto t =
        NearRoot(d_across.squaredNorm(), d_across.dot(o_across), o_across.squaredNorm() - r2);
    if (t && *t > 0) {
      const V3 p = from_a + *t * d;
      const double along = p.dot(axis) / axis2;
      if (along >= 0 && along <= 1) {
        return CapsuleHit{*t / length, (p - along * axis) / capsule.radius};
      }
    }
  }
  std::optional<CapsuleHit> first;
  for (const V3& end : {capsule.a, capsule.b}) {
    const V3 from_end = origin - end;
    const auto t = NearRoot(1, d.dot(from_end), from_end.squaredNorm() - r2);
    if (!t || *t <= 0 || (first && first->distance <= *t / length)) continue;
    first = CapsuleHit{*t / length, (from_end + *t * d) / capsule.radius};
  }
  return first;
}

Occluder MakeOccluder(OccluderKind kind, const Camera& camera, const Pose& camera_from_world,
                      const V3& center, RandomStream& random) {
  const double depth = random.Uniform(0.4, 0.6) * (camera_from_world * center).z();
  const double angle = 2 * std::numbers::pi * random.Uniform();
  const V3 inwards(std::cos(angle), std::sin(angle), 0);  // camera frame, towards the tip
  // From the middle, in units of half the picture's height.
  const bool stick = kind == OccluderKind::kStick;
  const double reach = stick ? random.Uniform(-0.4, 0.4) : random.Uniform(0.1, 0.6);
  const double aside = random.Uniform(-0.4, 0.4);
  const double half_height = 0.5 * camera.height / camera.fy * depth;
  const V3 across(-inwards.y(), inwards.x(), 0);
  const V3 tip = V3(0, 0, depth) + half_height * (aside * across - reach * inwards);
  Occluder occluder;
  if (stick) {
    occluder.albedo = {0.42f, 0.28f, 0.15f};
    // The far end is nearer to the camera, as if held from there.
    occluder.capsules.push_back({tip, tip - 400 * (inwards + V3(0, 0, 0.2)).normalized(), 2.5});
  } else {
    occluder.albedo = {0.55f, 0.34f, 0.25f};
    const V3 x = (inwards + V3(0, 0, 0.15)).normalized();
    const double roll = random.Uniform(-0.5, 0.5);
    V3 z = V3(0, 0, -1) * std::cos(roll) + across * std::sin(roll);
    z = (z - z.dot(x) * x).normalized();
    Eigen::Matrix3d camera_from_hand;
    camera_from_hand << x, z.cross(x), z;
    for (const Capsule& c : HandCapsules()) {
      occluder.capsules.push_back(
          {tip + camera_from_hand * c.a, tip + camera_from_hand * c.b, c.radius});
    }
  }
  const Pose world_from_camera = camera_from_world.Inverse();
  for (Capsule& c : occluder.capsules) {
    c.a = world_from_camera * c.a;
    c.b = world_from_camera * c.b;
  }
  return occluder;
}

TriangleMesh OccluderMesh(const Occluder& occluder) {
  TriangleMesh mesh;
  for (const Capsule& capsule : occluder.capsules) AppendCapsule(capsule, mesh);
  return mesh;
}

void MaskOccluder(const Occluder& occluder, const PixelRays& rays, const Pose& camera_from_world,
                  Image& mask) {
  const Lighting dark;
  const OccluderTracer tracer(occluder, dark, rays, camera_from_world);
  ParallelFor(
      0, rays.camera().height, [&](int64_t y) { tracer.MaskRow(static_cast<int>(y), mask); }, 8);
}

void CoverWithOccluder(const Occluder& occluder, const Lighting& lighting, const PixelRays& rays,
                       const Pose& camera_from_world, RenderedPhoto& photo) {
  const OccluderTracer tracer(occluder, lighting, rays, camera_from_world);
  ParallelFor(
      0, rays.camera().height, [&](int64_t y) { tracer.CoverRow(static_cast<int>(y), photo); }, 8);
}

}  // namespace lfm
