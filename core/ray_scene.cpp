// SPDX-License-Identifier: BSD-3-Clause
#include "core/ray_scene.h"

#include <embree3/rtcore.h>
#include <tbb/task_arena.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>

#include "core/error.h"

namespace lfm {
namespace {

struct DeviceDeleter {
  void operator()(RTCDevice device) const { rtcReleaseDevice(device); }
};
struct SceneDeleter {
  void operator()(RTCScene scene) const { rtcReleaseScene(scene); }
};
using Device = std::unique_ptr<std::remove_pointer_t<RTCDevice>, DeviceDeleter>;
using Scene = std::unique_ptr<std::remove_pointer_t<RTCScene>, SceneDeleter>;

constexpr double kFarthest = 1e30;

struct Barycentrics {
  double u = 0, v = 0;
};

/// Closest point of a triangle (C. Ericson, Real-Time Collision Detection, section 5.1.5). A
/// degenerate triangle is its longest edge or its point.
Eigen::Vector3d ClosestOnSegment(const Eigen::Vector3d& p, const Eigen::Vector3d& a,
                                 const Eigen::Vector3d& b) {
  const Eigen::Vector3d ab = b - a;
  const double length2 = ab.squaredNorm();
  if (!(length2 > 0)) return a;
  return a + std::clamp(ab.dot(p - a) / length2, 0.0, 1.0) * ab;
}

Eigen::Vector3d ClosestOnTriangle(const Eigen::Vector3d& p, const Eigen::Vector3d& a,
                                  const Eigen::Vector3d& b, const Eigen::Vector3d& c) {
  const Eigen::Vector3d normal = (b - a).cross(c - a);
  const double area2 = normal.squaredNorm();
  if (area2 > 0) {
    const Eigen::Vector3d ap = p - a;
    const double v = normal.dot(ap.cross(c - a)) / area2;
    const double w = normal.dot((b - a).cross(ap)) / area2;
    if (v >= 0 && w >= 0 && v + w <= 1) return a + v * (b - a) + w * (c - a);
  }
  Eigen::Vector3d best = ClosestOnSegment(p, a, b);
  for (const Eigen::Vector3d& other : {ClosestOnSegment(p, b, c), ClosestOnSegment(p, c, a)}) {
    if ((other - p).squaredNorm() < (best - p).squaredNorm()) best = other;
  }
  return best;
}

/// Whether a triangle's plane alone lies farther from `p` than `distance`, rounding aside: most of
/// those that a search visits need no more.
bool PlaneIsFarther(const Eigen::Vector3d& p, const Eigen::Vector3d& a, const Eigen::Vector3d& b,
                    const Eigen::Vector3d& c, double distance) {
  constexpr double kRounding_rel = 1e-9, kRoundingOfPoints_rel = 1e-12;
  const Eigen::Vector3d normal = (b - a).cross(c - a);
  const double off = normal.dot(p - a);
  const double reach = distance * (1 + kRounding_rel) + kRoundingOfPoints_rel * (p - a).lpNorm<1>();
  return off * off > reach * reach * normal.squaredNorm();
}

/// The float32 found the triangle; weights outside it by rounding are brought back.
Barycentrics OntoTriangle(double u, double v) {
  u = std::max(u, 0.0);
  v = std::max(v, 0.0);
  const double sum = u + v;
  if (sum > 1) {
    u /= sum;
    v = std::min(v / sum, 1 - u);
  }
  return {u, v};
}

/// Writes a ray into place `i` of a packet.
void SetRay(const RTCRay& ray, size_t i, RTCRay8& packet) {
  packet.org_x[i] = ray.org_x;
  packet.org_y[i] = ray.org_y;
  packet.org_z[i] = ray.org_z;
  packet.tnear[i] = ray.tnear;
  packet.dir_x[i] = ray.dir_x;
  packet.dir_y[i] = ray.dir_y;
  packet.dir_z[i] = ray.dir_z;
  packet.tfar[i] = ray.tfar;
  packet.mask[i] = ray.mask;
}

}  // namespace

/// Embree holds the mesh centred at the origin and scaled to radius 1: x' = (x - center) / radius.
struct RayScene::State {
  Device device;
  Scene scene;
  Eigen::Vector3d center = Eigen::Vector3d::Zero();
  double radius = 1;
  std::vector<Eigen::Vector3d> vertices;
  std::vector<Eigen::Vector3i> triangles;

  void Build();

  /// A radius in Embree's frame that reaches `distance` (mm) from `query`, and a little farther for
  /// what float32 lost of the query and of the boxes.
  float SearchRadius(const Eigen::Vector3d& query, double distance) const {
    const double reach = distance / radius;
    const double offset = (query - center).norm() / radius;
    return static_cast<float>(std::min(reach + 1e-6 * (1 + reach + offset), 1e30));
  }

  /// A ray in Embree's frame that starts where it enters the scene: float32 would lose digits of an
  /// origin that lies far away.
  struct LocalRay {
    RTCRay ray;
    double start;  ///< distance (mm) along the unit direction of where `ray` starts
    double scale;  ///< mm per unit of the caller's t
    Eigen::Vector3d unit;
  };
  std::optional<LocalRay> MakeRay(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction,
                                  double t_min, double t_max) const;

  /// What float32 found, in double precision.
  struct FoundInFloat {
    unsigned triangle;
    float tfar, u, v;
  };
  RayHit Refine(const Eigen::Vector3d& origin, const LocalRay& local,
                const FoundInFloat& found) const;
};

void RayScene::State::Build() {
  Eigen::AlignedBox3d box;
  for (const Eigen::Vector3d& vertex : vertices) box.extend(vertex);
  center = 0.5 * box.min() + 0.5 * box.max();
  radius = (box.max() - center).norm();
  if (!(radius > 0)) radius = 1;
  device.reset(rtcNewDevice(nullptr));
  if (!device) throw Error("the ray caster could not be started", ErrorKind::kSystem);
  scene.reset(rtcNewScene(device.get()));
  rtcSetSceneFlags(scene.get(), RTC_SCENE_FLAG_ROBUST);
  RTCGeometry geometry = rtcNewGeometry(device.get(), RTC_GEOMETRY_TYPE_TRIANGLE);
  auto* points = static_cast<float*>(rtcSetNewGeometryBuffer(
      geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 3 * sizeof(float), vertices.size()));
  auto* corners = static_cast<unsigned*>(
      rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                              3 * sizeof(unsigned), triangles.size()));
  if (points && corners) {
    for (size_t i = 0; i < vertices.size(); ++i) {
      Eigen::Map<Eigen::Vector3f>(points + 3 * i) = ((vertices[i] - center) / radius).cast<float>();
    }
    for (size_t i = 0; i < triangles.size(); ++i) {
      for (int c = 0; c < 3; ++c) corners[3 * i + c] = static_cast<unsigned>(triangles[i][c]);
    }
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene.get(), geometry);
  }
  rtcReleaseGeometry(geometry);
  // The shape of the tree decides which triangle of a shared edge is hit; built by one thread it
  // does not depend on how many there are.
  tbb::task_arena(1).execute([&] { rtcCommitScene(scene.get()); });
  if (rtcGetDeviceError(device.get()) != RTC_ERROR_NONE) {
    throw Error("the ray caster ran out of memory", ErrorKind::kSystem);
  }
}

std::optional<RayScene::State::LocalRay> RayScene::State::MakeRay(const Eigen::Vector3d& origin,
                                                                  const Eigen::Vector3d& direction,
                                                                  double t_min,
                                                                  double t_max) const {
  const double scale = direction.norm();
  if (!origin.allFinite() || !std::isfinite(scale) || !(scale > 0) || !(t_min <= t_max)) {
    return std::nullopt;
  }
  LocalRay local;
  local.scale = scale;
  local.unit = direction / scale;
  const double first = t_min * scale, last = t_max * scale;
  // A sphere a little larger than the scene's, so that nothing is cut off by rounding.
  const double along = local.unit.dot(center - origin);
  const double miss2 = (origin + along * local.unit - center).squaredNorm();
  const double reach = 1.001 * radius;
  if (miss2 > reach * reach) return std::nullopt;
  const double half = std::sqrt(reach * reach - miss2);
  local.start = std::max(first, along - half);
  const double end = std::min(last, along + half);
  if (!(local.start <= end)) return std::nullopt;
  const Eigen::Vector3f start =
      ((origin + local.start * local.unit - center) / radius).cast<float>();
  const Eigen::Vector3f unit = local.unit.cast<float>();
  local.ray = {};
  local.ray.org_x = start.x();
  local.ray.org_y = start.y();
  local.ray.org_z = start.z();
  local.ray.dir_x = unit.x();
  local.ray.dir_y = unit.y();
  local.ray.dir_z = unit.z();
  local.ray.tnear = 0;
  local.ray.tfar = static_cast<float>((end - local.start) / radius);
  local.ray.mask = ~0u;
  return local;
}

RayScene::RayScene(const TriangleMesh& mesh) : state_(std::make_unique<State>()) {
  ValidateMesh(mesh, "a mesh for ray casting");
  state_->vertices = mesh.vertices;
  state_->triangles = mesh.triangles;
  state_->Build();
}

RayScene::~RayScene() = default;
RayScene::RayScene(RayScene&&) noexcept = default;
RayScene& RayScene::operator=(RayScene&&) noexcept = default;

RayHit RayScene::State::Refine(const Eigen::Vector3d& origin, const LocalRay& local,
                               const FoundInFloat& found) const {
  RayHit hit;
  hit.triangle = static_cast<int>(found.triangle);
  const Eigen::Vector3i& corners = triangles[found.triangle];
  const Eigen::Vector3d& a = vertices[corners[0]];
  const Eigen::Vector3d ab = vertices[corners[1]] - a;
  const Eigen::Vector3d ac = vertices[corners[2]] - a;
  double distance = local.start + static_cast<double>(found.tfar) * radius;
  Barycentrics weights{found.u, found.v};
  // Moeller and Trumbore's solution in double precision, unless the ray lies in the plane.
  const Eigen::Vector3d p = local.unit.cross(ac);
  const double determinant = ab.dot(p);
  constexpr double kGrazing_rel = 1e-9;
  if (std::abs(determinant) > kGrazing_rel * ab.norm() * ac.norm()) {
    const Eigen::Vector3d from_a = origin - a;
    const Eigen::Vector3d q = from_a.cross(ab);
    weights = {from_a.dot(p) / determinant, local.unit.dot(q) / determinant};
    distance = ac.dot(q) / determinant;
  }
  weights = OntoTriangle(weights.u, weights.v);
  hit.u = weights.u;
  hit.v = weights.v;
  hit.distance = distance / local.scale;
  return hit;
}

std::optional<RayHit> RayScene::Intersect(const Eigen::Vector3d& origin,
                                          const Eigen::Vector3d& direction, double t_min,
                                          double t_max) const {
  const auto local = state_->MakeRay(origin, direction, t_min, t_max);
  if (!local) return std::nullopt;
  RTCRayHit query{};
  query.ray = local->ray;
  query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  rtcIntersect1(state_->scene.get(), &context, &query);
  if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) return std::nullopt;
  RayHit hit =
      state_->Refine(origin, *local, {query.hit.primID, query.ray.tfar, query.hit.u, query.hit.v});
  hit.distance = std::clamp(hit.distance, t_min, t_max);
  return hit;
}

void RayScene::FirstDistances(const Eigen::Vector3d& origin,
                              std::span<const Eigen::Vector3d> directions,
                              std::span<double> distances) const {
  constexpr size_t kPacket = 8;
  for (size_t begin = 0; begin < directions.size(); begin += kPacket) {
    const size_t count = std::min(kPacket, directions.size() - begin);
    std::array<std::optional<State::LocalRay>, kPacket> local;
    alignas(32) std::array<int, kPacket> valid{};  // -1: trace
    RTCRayHit8 query{};
    bool any = false;
    for (size_t i = 0; i < count; ++i) {
      distances[begin + i] = std::numeric_limits<double>::infinity();
      local[i] = state_->MakeRay(origin, directions[begin + i], 0, kFarthest);
      query.hit.geomID[i] = RTC_INVALID_GEOMETRY_ID;
      if (!local[i]) continue;
      SetRay(local[i]->ray, i, query.ray);
      valid[i] = -1;
      any = true;
    }
    if (!any) continue;
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
    rtcIntersect8(valid.data(), state_->scene.get(), &context, &query);
    for (size_t i = 0; i < count; ++i) {
      if (valid[i] == 0 || query.hit.geomID[i] == RTC_INVALID_GEOMETRY_ID) continue;
      const State::FoundInFloat found{query.hit.primID[i], query.ray.tfar[i], query.hit.u[i],
                                      query.hit.v[i]};
      const double distance = state_->Refine(origin, *local[i], found).distance;
      distances[begin + i] = std::clamp(distance, 0.0, kFarthest);
    }
  }
}

bool RayScene::Occluded(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction,
                        double t_min, double t_max) const {
  auto local = state_->MakeRay(origin, direction, t_min, t_max);
  if (!local) return false;
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  rtcOccluded1(state_->scene.get(), &context, &local->ray);
  return local->ray.tfar < 0;
}

std::optional<RayScene::ClosestPoint> RayScene::Closest(const Eigen::Vector3d& query,
                                                        double max_distance) const {
  if (!query.allFinite() || !(max_distance >= 0)) return std::nullopt;
  struct Search {
    const State* state;
    Eigen::Vector3d query;
    ClosestPoint best;
  } search{state_.get(), query, {query, -1, std::numeric_limits<double>::infinity()}};
  const Eigen::Vector3f local = ((query - state_->center) / state_->radius).cast<float>();
  RTCPointQuery point{local.x(), local.y(), local.z(), 0,
                      state_->SearchRadius(query, max_distance)};
  RTCPointQueryContext context;
  rtcInitPointQueryContext(&context);
  const auto visit = [](RTCPointQueryFunctionArguments* arguments) {
    auto& s = *static_cast<Search*>(arguments->userPtr);
    const int triangle = static_cast<int>(arguments->primID);
    const Eigen::Vector3i& t = s.state->triangles[triangle];
    const std::vector<Eigen::Vector3d>& v = s.state->vertices;
    if (PlaneIsFarther(s.query, v[t[0]], v[t[1]], v[t[2]], s.best.distance)) return false;
    const Eigen::Vector3d closest = ClosestOnTriangle(s.query, v[t[0]], v[t[1]], v[t[2]]);
    const double distance = (closest - s.query).norm();
    const bool nearer =
        distance < s.best.distance || (distance == s.best.distance && triangle < s.best.triangle);
    if (!nearer) return false;
    s.best = {closest, triangle, distance};
    arguments->query->radius =
        std::min(arguments->query->radius, s.state->SearchRadius(s.query, distance));
    return true;
  };
  rtcPointQuery(state_->scene.get(), &point, &context, visit, &search);
  if (search.best.triangle < 0 || search.best.distance > max_distance) return std::nullopt;
  return search.best;
}

}  // namespace lfm
