// SPDX-License-Identifier: BSD-3-Clause
#include "sample_data/traced_scene.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/error.h"
#include "sample_data/bsdf.h"
#include "sample_data/lanes/lane_convert.h"
#include "sample_data/lanes/lane_surface.h"
#include "sample_data/layer_albedo.h"

namespace lfm {
namespace {

using V3f = Eigen::Vector3f;

bool PassesLight(const SceneObject& object) {
  return object.material.kind == MaterialKind::kGlass || IsDelta(object.material);
}

}  // namespace

TracedScene::TracedScene(const std::vector<SceneObject>& objects, std::vector<Patch> patches,
                         const SetReflectance* reflectance)
    : objects_(&objects), patches_(std::move(patches)), reflectance_(reflectance) {
  if (!patches_.empty() && reflectance == nullptr) {
    throw Error("the set has no reflectance", ErrorKind::kSystem);
  }
  for (const SceneObject& object : objects) Add(object);
  AddSet();
  // Lanes without a hit read the first of everything, and Embree 16 bytes at the last vertex.
  vertices_.resize(vertices_.size() + kVertexStride);
  triangles_.resize(triangles_.size() + 3);
  patch_floats_.resize(patch_floats_.size() + kPatchFloats);
  constexpr size_t kMost = std::numeric_limits<int32_t>::max();  // lanes count in 32 bits
  if (vertices_.size() > kMost || triangles_.size() > kMost) {
    throw Error("the scene's meshes have more than 130 million vertices; decimate them");
  }
  tables_.vertices = vertices_.data();
  tables_.triangles = triangles_.data();
  tables_.geometry_ints = geometry_ints_.data();
  tables_.geometry_floats = geometry_floats_.data();
  tables_.patches = patch_floats_.data();

  device_ = rtcNewDevice(nullptr);
  if (device_ == nullptr) throw Error("Embree could not be started", ErrorKind::kSystem);
  scene_ = rtcNewScene(device_);
  rtcSetSceneFlags(scene_, RTC_SCENE_FLAG_ROBUST);
  const size_t geometries = objects.size() + 1;
  for (size_t i = 0; i < geometries; ++i) {
    const int first = geometry_ints_[i * kGeometryInts];
    const int end = i + 1 < geometries ? geometry_ints_[(i + 1) * kGeometryInts]
                                       : static_cast<int>(triangles_.size() / 3) - 1;
    Attach(static_cast<unsigned>(i), first, end - first);
  }
  rtcCommitScene(scene_);
  if (rtcGetDeviceError(device_) != RTC_ERROR_NONE) {
    rtcReleaseScene(scene_);
    rtcReleaseDevice(device_);
    throw Error("Embree could not build the scene: out of memory?", ErrorKind::kSystem);
  }
}

TracedScene::~TracedScene() {
  rtcReleaseScene(scene_);
  rtcReleaseDevice(device_);
}

void TracedScene::Add(const SceneObject& object) {
  ValidateMesh(object.mesh, ("object '" + object.name + "'").c_str());
  ValidateSurface(object);
  if (PassesLight(object)) has_specular_paths_ = true;
  const bool painted = !object.paint.empty();
  const MaterialKind kind = painted ? MaterialKind::kPaint : object.material.kind;
  const LayerTables layers = LayerTablesFor(kind);
  if (layers.dielectric != nullptr) {
    tables_.layers.dielectric = layers.dielectric;
    tables_.layers.dielectric_mean = layers.dielectric_mean;
  }
  if (layers.fuzz != nullptr) {
    tables_.layers.fuzz = layers.fuzz;
    tables_.layers.fuzz_mean = layers.fuzz_mean;
  }
  const Material& m = object.material;
  const int32_t flags = (painted ? kPainted : 0) | (object.uv.empty() ? 0 : kHasCoordinates) |
                        (!painted && object.texture.kind != TextureKind::kNone ? kLookedUp : 0);
  const auto first_triangle = static_cast<int32_t>(triangles_.size() / 3);
  geometry_ints_.insert(geometry_ints_.end(),
                        {first_triangle, static_cast<int32_t>(kind), flags, 0});
  const V3f &d = m.diffuse, &s = m.specular, &a = m.absorption_per_mm;
  geometry_floats_.insert(geometry_floats_.end(),
                          {d.x(), d.y(), d.z(), s.x(), s.y(), s.z(), m.exponent, m.alpha_u,
                           m.alpha_v, m.ior, a.x(), a.y(), a.z(), 0, 0, 0});
  texture_frames_.push_back(MakeTextureFrame(object));

  const auto first_vertex = static_cast<int32_t>(vertices_.size() / kVertexStride);
  const auto normals =
      object.mesh.normals.empty() ? ComputeVertexNormals(object.mesh) : object.mesh.normals;
  vertices_.reserve(vertices_.size() + kVertexStride * (object.mesh.vertices.size() + 1));
  for (size_t v = 0; v < object.mesh.vertices.size(); ++v) {
    const V3f p = object.mesh.vertices[v].cast<float>(), n = normals[v].cast<float>();
    const Paint paint = painted ? object.paint[v] : Paint{};
    const Eigen::Vector2f uv =
        object.uv.empty() ? Eigen::Vector2f(Eigen::Vector2f::Zero()) : object.uv[v];
    vertices_.insert(vertices_.end(),
                     {p.x(), p.y(), p.z(), n.x(), n.y(), n.z(), uv.x(), uv.y(), paint.diffuse.x(),
                      paint.diffuse.y(), paint.diffuse.z(), paint.coat.x(), paint.coat.y(),
                      paint.coat.z(), paint.alpha, 0});
  }
  for (const auto& t : object.mesh.triangles) {
    for (int c = 0; c < 3; ++c) triangles_.push_back(first_vertex + t[c]);
  }
}

void TracedScene::AddSet() {
  const Material plain;
  geometry_ints_.insert(geometry_ints_.end(), {static_cast<int32_t>(triangles_.size() / 3),
                                               kLaneLambert, kIsPatch | kLookedUp, 0});
  geometry_floats_.insert(geometry_floats_.end(),
                          {0.5f, 0.5f, 0.5f, 0, 0, 0, plain.exponent, plain.alpha_u, plain.alpha_v,
                           plain.ior, 0, 0, 0, 0, 0, 0});
  for (const Patch& patch : patches_) {
    const auto first = static_cast<int32_t>(vertices_.size() / kVertexStride);
    const V3f origin = patch.origin.cast<float>(), n = patch.Normal().cast<float>();
    patch_floats_.insert(patch_floats_.end(),
                         {origin.x(), origin.y(), origin.z(), n.x(), n.y(), n.z(), 0, 0});
    const Eigen::Vector3d corners[4] = {
        patch.origin, patch.origin + patch.width * patch.u,
        patch.origin + patch.width * patch.u + patch.height * patch.v,
        patch.origin + patch.height * patch.v};
    for (const auto& corner : corners) {
      const V3f p = corner.cast<float>();
      vertices_.insert(vertices_.end(),
                       {p.x(), p.y(), p.z(), n.x(), n.y(), n.z(), 0, 0, 0, 0, 0, 0, 0, 0, 0, 0});
    }
    for (const int corner : {0, 1, 2, 0, 2, 3}) triangles_.push_back(first + corner);
  }
}

void TracedScene::Attach(unsigned id, int first_triangle, int triangles) {
  if (triangles == 0) return;
  RTCGeometry g = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
  rtcSetSharedGeometryBuffer(g, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, vertices_.data(), 0,
                             kVertexStride * sizeof(float), vertices_.size() / kVertexStride);
  rtcSetSharedGeometryBuffer(g, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, triangles_.data(),
                             3 * sizeof(int32_t) * static_cast<size_t>(first_triangle),
                             3 * sizeof(int32_t), static_cast<size_t>(triangles));
  rtcCommitGeometry(g);
  rtcAttachGeometryByID(scene_, g, id);
  rtcReleaseGeometry(g);
}

void TracedScene::Intersect(RayPacket& packet, RayOrder order) const {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  context.flags = order == RayOrder::kCoherent ? RTC_INTERSECT_CONTEXT_FLAG_COHERENT
                                               : RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
  rtcIntersect16(packet.valid, scene_, &context, &packet.rays);
}

void TracedScene::Occlude(const int* valid, RTCRay16& rays, RayOrder order) const {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  context.flags = order == RayOrder::kCoherent ? RTC_INTERSECT_CONTEXT_FLAG_COHERENT
                                               : RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
  rtcOccluded16(valid, scene_, &context, &rays);
}

namespace {

SurfacePoint TurnedPoint(const LaneSurface<float>& found, const Material& material,
                         const V3f& to_eye) {
  SurfacePoint surface;
  surface.position = FromLane(found.position);
  surface.material = material;
  const LaneFrame<float> frame = TurnToEye(found, ToLane(to_eye));
  surface.facet = FromLane(frame.facet);
  surface.frame = {FromLane(frame.x), FromLane(frame.y), FromLane(frame.z)};
  return surface;
}

}  // namespace

Material TracedScene::ColorsAt(int object, int triangle, float u, float v,
                               const V3f& position) const {
  return ResolveMaterial((*objects_)[object], texture_frames_[object], triangle, u, v, position);
}

SurfacePoint TracedScene::SurfaceAt(int object, int triangle, float u, float v,
                                    const V3f& to_eye) const {
  LaneHit<float> hit = {object, triangle, u, v, 0, {0, 0, 0}, {0, 0, 0}};
  LaneSurface<float> found = FetchSurface(tables_, hit);
  const Material material = ColorsAt(object, triangle, u, v, FromLane(found.position));
  found.material = ToLane(material);
  SurfacePoint surface = TurnedPoint(found, material, to_eye);
  surface.object = object;
  return surface;
}

SurfacePoint TracedScene::Surface(const RayPacket& packet, int lane, const V3f& direction) const {
  const RTCHit16& hit = packet.rays.hit;
  const RTCRay16& ray = packet.rays.ray;
  const unsigned id = hit.geomID[lane];
  if (IsObject(id)) {
    return SurfaceAt(static_cast<int>(id), static_cast<int>(hit.primID[lane]), hit.u[lane],
                     hit.v[lane], -direction);
  }
  const LaneHit<float> met = {static_cast<int32_t>(id),
                              static_cast<int32_t>(hit.primID[lane]),
                              hit.u[lane],
                              hit.v[lane],
                              ray.tfar[lane],
                              {ray.org_x[lane], ray.org_y[lane], ray.org_z[lane]},
                              ToLane(direction)};
  const LaneSurface<float> found = FetchSurface(tables_, met);
  const int patch = met.triangle / 2;
  Material material;
  material.kind = MaterialKind::kLambert;
  material.diffuse = reflectance_->Color(patches_[patch], FromLane(found.position));
  SurfacePoint surface = TurnedPoint(found, material, -direction);
  surface.patch = patch;
  return surface;
}

void TracedScene::LookUpColors(const RayPacket& packet, int lanes, SurfacePack& pack) const {
  const RTCHit16& hit = packet.rays.hit;
  for (int lane = 0; lane < lanes; ++lane) {
    if ((pack.flags[lane] & kLookedUp) == 0) continue;
    const V3f position(pack.position[0][lane], pack.position[1][lane], pack.position[2][lane]);
    if ((pack.flags[lane] & kIsPatch) != 0) {
      const V3f color = reflectance_->Color(patches_[hit.primID[lane] / 2], position);
      for (int c = 0; c < 3; ++c) pack.diffuse[c][lane] = color[c];
      continue;
    }
    const Material material =
        ColorsAt(static_cast<int>(hit.geomID[lane]), static_cast<int>(hit.primID[lane]),
                 hit.u[lane], hit.v[lane], position);
    for (int c = 0; c < 3; ++c) {
      pack.diffuse[c][lane] = material.diffuse[c];
      pack.specular[c][lane] = material.specular[c];
    }
  }
}

V3f TracedScene::Departure(const SurfacePoint& surface, const V3f& direction) {
  return FromLane(DepartFrom(ToLane(surface.position), ToLane(surface.facet), ToLane(direction)));
}

}  // namespace lfm
