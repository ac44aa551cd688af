// SPDX-License-Identifier: BSD-3-Clause
#include "sample_data/traced_scene.h"

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "sample_data/bsdf.h"
#include "sample_data/microfacet.h"

namespace lfm {
namespace {

using V3f = Eigen::Vector3f;

// A tangent that runs round the vertical axis.
V3f AroundVertical(const V3f& n) {
  const V3f t(-n.y(), n.x(), 0);
  const float length2 = t.squaredNorm();
  return length2 > 1e-8f ? V3f((1 / std::sqrt(length2)) * t) : V3f(1, 0, 0);
}

bool Mirrors(const Material& material) {
  return material.kind != MaterialKind::kLambert && material.kind != MaterialKind::kFuzz;
}

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
  geometry_.resize(objects.size() + 1);
  for (size_t i = 0; i < objects.size(); ++i) {
    const SceneObject& object = objects[i];
    ValidateMesh(object.mesh, ("object '" + object.name + "'").c_str());
    ValidateSurface(object);
    if (PassesLight(object)) has_specular_paths_ = true;
    Geometry& g = geometry_[i];
    for (const auto& p : object.mesh.vertices) {
      for (int c = 0; c < 3; ++c) g.positions.push_back(static_cast<float>(p[c]));
    }
    for (const auto& t : object.mesh.triangles) {
      for (int c = 0; c < 3; ++c) g.indices.push_back(static_cast<unsigned>(t[c]));
    }
    const auto normals =
        object.mesh.normals.empty() ? ComputeVertexNormals(object.mesh) : object.mesh.normals;
    for (const auto& n : normals) {
      for (int c = 0; c < 3; ++c) g.normals.push_back(static_cast<float>(n[c]));
    }
    g.texture_frame = MakeTextureFrame(object);
    g.plain = object.paint.empty() && object.texture.kind == TextureKind::kNone;
  }
  Geometry& set = geometry_.back();
  for (const Patch& patch : patches_) {
    const unsigned first = static_cast<unsigned>(set.positions.size() / 3);
    const Eigen::Vector3d corners[4] = {
        patch.origin, patch.origin + patch.width * patch.u,
        patch.origin + patch.width * patch.u + patch.height * patch.v,
        patch.origin + patch.height * patch.v};
    for (const auto& p : corners) {
      for (int c = 0; c < 3; ++c) set.positions.push_back(static_cast<float>(p[c]));
    }
    for (unsigned corner : {0u, 1u, 2u, 0u, 2u, 3u}) set.indices.push_back(first + corner);
  }

  device_ = rtcNewDevice(nullptr);
  if (device_ == nullptr) throw Error("Embree could not be started", ErrorKind::kSystem);
  scene_ = rtcNewScene(device_);
  rtcSetSceneFlags(scene_, RTC_SCENE_FLAG_ROBUST);
  for (size_t i = 0; i < geometry_.size(); ++i) Attach(static_cast<unsigned>(i), geometry_[i]);
  rtcCommitScene(scene_);
}

TracedScene::~TracedScene() {
  rtcReleaseScene(scene_);
  rtcReleaseDevice(device_);
}

void TracedScene::Attach(unsigned id, Geometry& geometry) {
  if (geometry.indices.empty()) return;
  const size_t vertices = geometry.positions.size() / 3;
  geometry.positions.push_back(0);  // Embree reads 16 bytes at the last vertex
  RTCGeometry g = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
  rtcSetSharedGeometryBuffer(g, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                             geometry.positions.data(), 0, 3 * sizeof(float), vertices);
  rtcSetSharedGeometryBuffer(g, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, geometry.indices.data(),
                             0, 3 * sizeof(unsigned), geometry.indices.size() / 3);
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

void TracedScene::FinishFrame(SurfacePoint& surface, V3f normal, const V3f* along,
                              const V3f& to_eye) const {
  constexpr float kGrazing = 0.02f;
  const bool glass = surface.material.kind == MaterialKind::kGlass;
  // The side of the facet that the eye is on; glass keeps its outward normal, all else turns.
  const bool behind = surface.facet.dot(to_eye) < 0;
  if (behind && !glass) {
    surface.facet = -surface.facet;
    normal = -normal;
  }
  const float side = behind && glass ? -1.0f : 1.0f;
  V3f n = side * normal;
  const V3f facet = side * surface.facet;
  const float facing = n.dot(to_eye);
  if (facing < kGrazing) n = UnitVector(n + (kGrazing - facing) * to_eye);
  if (Mirrors(surface.material)) {
    const V3f mirrored = 2 * n.dot(to_eye) * n - to_eye;
    const float low = std::min(0.9f * facet.dot(to_eye), 0.01f), out = mirrored.dot(facet);
    if (out < low) n = UnitVector(UnitVector(mirrored + (low - out) * facet) + to_eye);
  }
  surface.frame.z = side * n;
  const V3f t = along != nullptr ? *along : AroundVertical(surface.frame.z);
  V3f x = t - t.dot(surface.frame.z) * surface.frame.z;
  const float length = x.norm();
  surface.frame.x = length > 1e-4f ? V3f((1 / length) * x) : V3f(surface.frame.z.unitOrthogonal());
  surface.frame.y = surface.frame.z.cross(surface.frame.x);
}

SurfacePoint TracedScene::SurfaceAt(int object, int triangle, float u, float v,
                                    const V3f& to_eye) const {
  const Geometry& g = geometry_[object];
  const unsigned* t = &g.indices[3 * static_cast<size_t>(triangle)];
  const auto corner = [&](const std::vector<float>& values, int c) {
    return Eigen::Map<const V3f>(&values[3 * static_cast<size_t>(t[c])]);
  };
  const V3f a = corner(g.positions, 0), ab = corner(g.positions, 1) - a,
            ac = corner(g.positions, 2) - a;
  SurfacePoint surface;
  surface.object = object;
  surface.position = a + u * ab + v * ac;
  const V3f cross = ab.cross(ac);
  const float area = cross.norm();
  surface.facet = area > 0 ? V3f((1 / area) * cross) : V3f(0, 0, 1);
  V3f normal =
      (1 - u - v) * corner(g.normals, 0) + u * corner(g.normals, 1) + v * corner(g.normals, 2);
  const float length = normal.norm();
  normal = length > 1e-6f ? V3f((1 / length) * normal) : surface.facet;
  if (normal.dot(surface.facet) < 0) normal = surface.facet;
  const SceneObject& o = (*objects_)[object];
  surface.material =
      g.plain ? o.material : ResolveMaterial(o, g.texture_frame, triangle, u, v, surface.position);
  if (!o.uv.empty() && surface.material.alpha_u != surface.material.alpha_v) {
    const Eigen::Vector2f st = o.uv[t[1]] - o.uv[t[0]], pq = o.uv[t[2]] - o.uv[t[0]];
    const float determinant = st.x() * pq.y() - st.y() * pq.x();
    if (std::abs(determinant) > 1e-12f) {
      const V3f along = (pq.y() * ab - st.y() * ac) / determinant;
      const float size = along.norm();
      if (size > 0) {
        const V3f unit = along / size;
        FinishFrame(surface, normal, &unit, to_eye);
        return surface;
      }
    }
  }
  FinishFrame(surface, normal, nullptr, to_eye);
  return surface;
}

SurfacePoint TracedScene::Surface(const RayPacket& packet, int lane, const V3f& direction) const {
  const RTCHit16& hit = packet.rays.hit;
  const unsigned id = hit.geomID[lane];
  if (IsObject(id)) {
    return SurfaceAt(static_cast<int>(id), static_cast<int>(hit.primID[lane]), hit.u[lane],
                     hit.v[lane], -direction);
  }
  SurfacePoint surface;
  surface.patch = static_cast<int>(hit.primID[lane] / 2);
  const Patch& patch = patches_[surface.patch];
  const RTCRay16& ray = packet.rays.ray;
  surface.position =
      V3f(ray.org_x[lane], ray.org_y[lane], ray.org_z[lane]) + ray.tfar[lane] * direction;
  surface.facet = patch.Normal().cast<float>();
  // Onto the plane exactly: prints are looked up there, and rays leave from there.
  surface.position -=
      surface.facet.dot(surface.position - patch.origin.cast<float>()) * surface.facet;
  surface.material.kind = MaterialKind::kLambert;
  surface.material.diffuse = reflectance_->Color(patch, surface.position);
  FinishFrame(surface, surface.facet, nullptr, -direction);
  return surface;
}

V3f TracedScene::Departure(const SurfacePoint& surface, const V3f& direction) {
  const V3f& p = surface.position;
  const float size = std::max(20.0f, p.cwiseAbs().maxCoeff());
  const float side = surface.facet.dot(direction) < 0 ? -1.0f : 1.0f;
  return p + side * 1e-5f * size * surface.facet;
}

}  // namespace lfm
