// SPDX-License-Identifier: BSD-3-Clause
#include "sample_data/studio_scene.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "core/error.h"
#include "core/polygon.h"
#include "sample_data/paint.h"

namespace lfm {
namespace {

constexpr unsigned kObjectGeometry = 0, kPatchGeometry = 1;
constexpr float kInkAlbedo = 0.035f, kEdgeAlbedo = 0.35f;

// The mean value of a print over a polygon all round which it is `cross`, seen from `middle`.
double MeanOfCross(const PrintCross& cross, const Eigen::Vector2d& middle, const Polygon& outline) {
  const auto& v = cross.value;
  if (v[0][0] == v[0][1] && v[0][0] == v[1][0] && v[0][0] == v[1][1]) return v[0][0];
  const double all = PolygonArea(outline);
  if (!(all > 0)) return v[0][0];
  const Eigen::Vector2d &x = cross.x_axis, y(-x.y(), x.x());
  const Polygon left = ClipPolygon(outline, x, x.dot(middle) + cross.offset_mm.x());
  const double y_limit = y.dot(middle) + cross.offset_mm.y();
  const double below_x = PolygonArea(left) / all,
               below_y = PolygonArea(ClipPolygon(outline, y, y_limit)) / all;
  const double both = PolygonArea(ClipPolygon(left, y, y_limit)) / all;
  return v[0][0] * both + v[0][1] * (below_x - both) + v[1][0] * (below_y - both) +
         v[1][1] * (1 - below_x - below_y + both);
}

void AttachTriangles(RTCDevice device, RTCScene scene, unsigned id,
                     const std::vector<Eigen::Vector3d>& vertices,
                     const std::vector<Eigen::Vector3i>& triangles) {
  RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
  auto* points = static_cast<float*>(rtcSetNewGeometryBuffer(
      geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 3 * sizeof(float), vertices.size()));
  auto* indices = static_cast<unsigned*>(
      rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                              3 * sizeof(unsigned), triangles.size()));
  if (points == nullptr || indices == nullptr) {
    throw Error("no memory for the studio's ray scene", ErrorKind::kSystem);
  }
  for (size_t i = 0; i < vertices.size(); ++i) {
    for (int c = 0; c < 3; ++c) points[3 * i + c] = static_cast<float>(vertices[i][c]);
  }
  for (size_t i = 0; i < triangles.size(); ++i) {
    for (int c = 0; c < 3; ++c) indices[3 * i + c] = static_cast<unsigned>(triangles[i][c]);
  }
  rtcCommitGeometry(geometry);
  rtcAttachGeometryByID(scene, geometry, id);
  rtcReleaseGeometry(geometry);
}

}  // namespace

std::vector<Patch> MakePlateAndTable(const Board& board, const Pose& world_from_table) {
  using V3 = Eigen::Vector3d;
  std::vector<Patch> patches;
  const std::vector<BoardPlate> plates = PlatesOf(board);
  for (size_t i = 0; i < plates.size(); ++i) {
    const double w = plates[i].board->width_mm, h = plates[i].board->height_mm;
    const double t = i == 0 ? kPlateThicknessMm : kAttachedThicknessMm;
    std::vector<Patch> slab = {
        {V3(-w / 2, -h / 2, 0), V3::UnitX(), V3::UnitY(), w, h, PatchMaterial::kPrint},
        {V3(-w / 2, -h / 2, -t), V3::UnitX(), V3::UnitZ(), w, t, PatchMaterial::kEdge},
        {V3(w / 2, h / 2, -t), -V3::UnitX(), V3::UnitZ(), w, t, PatchMaterial::kEdge},
        {V3(w / 2, -h / 2, -t), V3::UnitY(), V3::UnitZ(), h, t, PatchMaterial::kEdge},
        {V3(-w / 2, h / 2, -t), -V3::UnitY(), V3::UnitZ(), h, t, PatchMaterial::kEdge},
    };
    // The back of one that stands upright is seen.
    if (i > 0) {
      slab.push_back(
          {V3(w / 2, -h / 2, -t), -V3::UnitX(), V3::UnitY(), w, h, PatchMaterial::kEdge});
    }
    const Pose& pose = plates[i].world_from_plate;
    for (Patch& patch : slab) {
      patch.plate = static_cast<int>(i);
      if (i > 0) {
        patch.origin = pose * patch.origin;
        patch.u = pose.rotation * patch.u;
        patch.v = pose.rotation * patch.v;
      }
      patches.push_back(patch);
    }
  }
  const double s = kTableSizeMm;
  patches.push_back({world_from_table * V3(-s / 2, -s / 2, 0),
                     world_from_table.rotation * V3::UnitX(),
                     world_from_table.rotation * V3::UnitY(), s, s, PatchMaterial::kTable});
  return patches;
}

RayPacket::RayPacket() {
  std::memset(&rays, 0, sizeof(rays));
  std::memset(valid, 0, sizeof(valid));
}

void RayPacket::Set(int lane, const Eigen::Vector3f& origin, const Eigen::Vector3f& direction,
                    float t_near, float t_far) {
  RTCRay16& ray = rays.ray;
  ray.org_x[lane] = origin.x();
  ray.org_y[lane] = origin.y();
  ray.org_z[lane] = origin.z();
  ray.dir_x[lane] = direction.x();
  ray.dir_y[lane] = direction.y();
  ray.dir_z[lane] = direction.z();
  ray.tnear[lane] = t_near;
  ray.tfar[lane] = t_far;
  ray.time[lane] = 0;
  ray.mask[lane] = ~0u;
  ray.id[lane] = static_cast<unsigned>(lane);
  ray.flags[lane] = 0;
  rays.hit.geomID[lane] = RTC_INVALID_GEOMETRY_ID;
  rays.hit.primID[lane] = RTC_INVALID_GEOMETRY_ID;
  rays.hit.instID[0][lane] = RTC_INVALID_GEOMETRY_ID;
  valid[lane] = -1;
}

StudioScene::StudioScene(const TriangleMesh* object, std::vector<Patch> patches)
    : patches_(std::move(patches)) {
  device_ = rtcNewDevice(nullptr);
  if (device_ == nullptr) throw Error("Embree could not be started", ErrorKind::kSystem);
  scene_ = rtcNewScene(device_);
  rtcSetSceneFlags(scene_, RTC_SCENE_FLAG_ROBUST);
  if (object != nullptr) {
    AttachTriangles(device_, scene_, kObjectGeometry, object->vertices, object->triangles);
  }
  std::vector<Eigen::Vector3d> vertices;
  std::vector<Eigen::Vector3i> triangles;
  for (const Patch& patch : patches_) {
    const int first = static_cast<int>(vertices.size());
    vertices.push_back(patch.origin);
    vertices.push_back(patch.origin + patch.width * patch.u);
    vertices.push_back(patch.origin + patch.width * patch.u + patch.height * patch.v);
    vertices.push_back(patch.origin + patch.height * patch.v);
    triangles.emplace_back(first, first + 1, first + 2);
    triangles.emplace_back(first, first + 2, first + 3);
  }
  if (!triangles.empty()) AttachTriangles(device_, scene_, kPatchGeometry, vertices, triangles);
  rtcCommitScene(scene_);
}

StudioScene::~StudioScene() {
  rtcReleaseScene(scene_);
  rtcReleaseDevice(device_);
}

void StudioScene::Intersect(RayPacket& packet, RayOrder order) const {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  context.flags = order == RayOrder::kCoherent ? RTC_INTERSECT_CONTEXT_FLAG_COHERENT
                                               : RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
  rtcIntersect16(packet.valid, scene_, &context, &packet.rays);
}

SurfaceHit StudioScene::Hit(const RayPacket& packet, int lane) {
  SurfaceHit hit;
  const RTCHit16& h = packet.rays.hit;
  if (h.geomID[lane] == RTC_INVALID_GEOMETRY_ID) return hit;
  hit.distance = packet.rays.ray.tfar[lane];
  if (h.geomID[lane] == kObjectGeometry) {
    hit.triangle = static_cast<int>(h.primID[lane]);
    hit.u = h.u[lane];
    hit.v = h.v[lane];
  } else {
    hit.patch = static_cast<int>(h.primID[lane] / 2);
  }
  return hit;
}

void StudioScene::Occlude(RayPacket& packet) const {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
  rtcOccluded16(packet.valid, scene_, &context, &packet.rays.ray);
}

bool StudioScene::Blocked(const RayPacket& packet, int lane) {
  return packet.rays.ray.tfar[lane] < 0;
}

SetReflectance::OnPrint SetReflectance::Locate(const Patch& patch,
                                               const Eigen::Vector3f& point) const {
  if (patch.plate == 0) return {&print_, point.head<2>().cast<double>()};
  const BoardPrint::Plate plate = print_.PlateAt(patch.plate);
  return {plate.print, (plate.plate_from_world * point.cast<double>()).head<2>()};
}

Eigen::Vector3f SetReflectance::Color(const Patch& patch, const Eigen::Vector3f& point) const {
  using V3f = Eigen::Vector3f;
  switch (patch.material) {
    case PatchMaterial::kPrint: {
      const OnPrint on = Locate(patch, point);
      const std::optional<V3f> color = on.print->Color(on.point);
      if (!color) return V3f::Constant(kEdgeAlbedo);
      return V3f::Constant(kInkAlbedo) + *color * (kPaperAlbedo - kInkAlbedo);
    }
    case PatchMaterial::kEdge:
      return V3f::Constant(kEdgeAlbedo);
    case PatchMaterial::kTable:
      break;
  }
  return V3f::Constant(
      kTableAlbedo * (1 + 0.35f * static_cast<float>(GradientNoise(point.cast<double>() / 25, 5))));
}

std::optional<Eigen::Vector3f> SetReflectance::PrintColor(
    const Patch& patch, const std::array<Eigen::Vector3f, 4>& piece) const {
  if (patch.material != PatchMaterial::kPrint) return std::nullopt;
  Polygon outline;
  const BoardPrint* print = nullptr;
  Eigen::Vector2d middle = {0, 0};
  for (const Eigen::Vector3f& corner : piece) {
    const OnPrint on = Locate(patch, corner);
    print = on.print;
    outline.push_back(on.point);
    middle += on.point / 4;
  }
  double reach = 0;
  for (const Eigen::Vector2d& corner : outline) reach = std::max(reach, (corner - middle).norm());
  const std::optional<PrintCross> cross = print->CrossNear(middle, reach);
  if (!cross) return std::nullopt;
  const double paper = MeanOfCross(*cross, middle, outline);
  return Eigen::Vector3f::Constant(kInkAlbedo +
                                   static_cast<float>(paper) * (kPaperAlbedo - kInkAlbedo));
}

float SetReflectance::Albedo(const Patch& patch, const Eigen::Vector3f& point) const {
  return Luminance(Color(patch, point));
}

float Luminance(const Eigen::Vector3f& color) {
  const bool gray = color.x() == color.y() && color.y() == color.z();
  return gray ? color.x() : color.dot(Eigen::Vector3f(0.2126f, 0.7152f, 0.0722f));
}

}  // namespace lfm
