// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "sample_data/lanes/lane_bsdf.h"
#include "sample_data/lanes/scene_tables.h"

namespace lfm {
inline namespace LFM_LANE_SET {

/// Where rays met surfaces. For lanes without a hit geometry, triangle and distance must be 0.
template <typename F>
struct LaneHit {
  IntOf<F> geometry, triangle;  ///< triangle of the geometry
  F u, v, distance;
  Vec<F> origin, direction;
};

/// Points of surfaces before they are turned to the eye.
template <typename F>
struct LaneSurface {
  Vec<F> position, facet, normal;  ///< unit normals, outward
  Vec<F> along;                    ///< the tangent to start from; 0 for round the vertical axis
  LaneMaterial<F> material;
  IntOf<F> flags;
};

/// Axes in which a BSDF is evaluated: z the shading normal, x the tangent.
template <typename F>
struct LaneFrame {
  Vec<F> x, y, z, facet;
  LFM_LANE Vec<F> Local(const Vec<F>& w) const { return {Dot(x, w), Dot(y, w), Dot(z, w)}; }
  LFM_LANE Vec<F> World(const Vec<F>& l) const { return l.x * x + l.y * y + l.z * z; }
};

template <typename F>
LFM_LANE Vec<F> UnitOr(const Vec<F>& v, float shortest, const Vec<F>& otherwise) {
  const F length = Sqrt(Dot(v, v));
  const MaskOf<F> usable = length > shortest;
  return Select<F>(usable, (1.0f / Select(usable, length, Splat<F>(1))) * v, otherwise);
}

// The direction in which the first texture coordinate grows; 0 where there is none.
template <typename F>
LFM_LANE Vec<F> AlongCoordinates(const Row<F>& a, const Row<F>& b, const Row<F>& c,
                                 const Vec<F>& ab, const Vec<F>& ac) {
  const F s = b.at[6] - a.at[6], t = b.at[7] - a.at[7];
  const F p = c.at[6] - a.at[6], q = c.at[7] - a.at[7];
  const F determinant = s * q - t * p;
  const MaskOf<F> usable = Abs(determinant) > 1e-12f;
  const F inverse = 1.0f / Select(usable, determinant, Splat<F>(1));
  return UnitOr(Select<F>(usable, inverse * (q * ab - t * ac), Gray(Splat<F>(0))), 0.0f,
                Gray(Splat<F>(0)));
}

template <typename F>
LFM_LANE LaneMaterial<F> MaterialOf(IntOf<F> kind, const Row<F>& first, const Row<F>& second) {
  LaneMaterial<F> m;
  m.kind = kind;
  m.diffuse = {first.at[0], first.at[1], first.at[2]};
  m.specular = {first.at[3], first.at[4], first.at[5]};
  m.exponent = first.at[6];
  m.alpha_u = first.at[7];
  m.alpha_v = second.at[0];
  m.ior = second.at[1];
  m.absorption = {second.at[2], second.at[3], second.at[4]};
  return m;
}

template <typename F>
LFM_LANE LaneMaterial<F> FetchMaterial(const SceneTables& scene, IntOf<F> geometry) {
  const int32_t one = FirstLane(geometry);
  if (All(geometry == one)) {
    const auto row = [&](int from) {
      Row<F> r;
      for (int i = 0; i < 8; ++i) {
        r.at[i] = Splat<F>(scene.geometry_floats[one * kGeometryFloats + from + i]);
      }
      return r;
    };
    return MaterialOf<F>(SplatInt<IntOf<F>>(scene.geometry_ints[one * kGeometryInts + 1]), row(0),
                         row(8));
  }
  const IntOf<F> at = geometry * kGeometryFloats;
  return MaterialOf<F>(Gather(scene.geometry_ints, geometry * kGeometryInts + 1),
                       GatherRow(scene.geometry_floats, at),
                       GatherRow(scene.geometry_floats, at + 8));
}

/// The points that rays met. What is kLookedUp keeps its geometry's plain material.
template <typename F>
LFM_LANE LaneSurface<F> FetchSurface(const SceneTables& scene, const LaneHit<F>& hit) {
  LaneSurface<F> s;
  s.flags = Gather(scene.geometry_ints, hit.geometry * kGeometryInts + 2);
  s.material = FetchMaterial<F>(scene, hit.geometry);
  s.along = Gray(Splat<F>(0));
  const MaskOf<F> patch = (s.flags & kIsPatch) != 0;
  const IntOf<F> first = Gather(scene.geometry_ints, hit.geometry * kGeometryInts);
  const IntOf<F> triangle = (first + hit.triangle) * 3;
  const auto vertex = [&](int c) { return Gather(scene.triangles, triangle + c) * kVertexStride; };
  const IntOf<F> va = vertex(0), vb = vertex(1), vc = vertex(2);
  const Row<F> a = GatherRow(scene.vertices, va), b = GatherRow(scene.vertices, vb),
               c = GatherRow(scene.vertices, vc);
  const auto vec = [](const Row<F>& row, int i) {
    return Vec<F>{row.at[i], row.at[i + 1], row.at[i + 2]};
  };
  const Vec<F> pa = vec(a, 0), ab = vec(b, 0) - pa, ac = vec(c, 0) - pa;
  s.position = pa + hit.u * ab + hit.v * ac;
  s.facet = UnitOr(Cross(ab, ac), 0.0f, {Splat<F>(0), Splat<F>(0), Splat<F>(1)});
  const F w = 1.0f - hit.u - hit.v;
  s.normal = UnitOr(w * vec(a, 3) + hit.u * vec(b, 3) + hit.v * vec(c, 3), 1e-6f, s.facet);
  s.normal = Select<F>(Dot(s.normal, s.facet) < 0.0f, s.facet, s.normal);
  const MaskOf<F> painted = (s.flags & kPainted) != 0;
  if (Any(painted)) {
    const Row<F> ra = GatherRow(scene.vertices, va + 8), rb = GatherRow(scene.vertices, vb + 8),
                 rc = GatherRow(scene.vertices, vc + 8);
    const auto blend = [&](int i) { return w * ra.at[i] + hit.u * rb.at[i] + hit.v * rc.at[i]; };
    const F alpha = blend(6);
    s.material.diffuse = Select<F>(painted, {blend(0), blend(1), blend(2)}, s.material.diffuse);
    s.material.specular = Select<F>(painted, {blend(3), blend(4), blend(5)}, s.material.specular);
    s.material.alpha_u = Select(painted, alpha, s.material.alpha_u);
    s.material.alpha_v = Select(painted, alpha, s.material.alpha_v);
  }
  const MaskOf<F> brushed =
      ((s.flags & kHasCoordinates) != 0) & (s.material.alpha_u != s.material.alpha_v);
  if (Any(brushed)) {
    s.along = Select<F>(brushed, AlongCoordinates<F>(a, b, c, ab, ac), s.along);
  }
  if (Any(patch)) {
    const IntOf<F> row = Select(patch, (hit.triangle >> 1) * kPatchFloats, SplatInt<IntOf<F>>(0));
    const Row<F> plane = GatherRow(scene.patches, row);
    const Vec<F> normal = vec(plane, 3);
    const Vec<F> on_ray = hit.origin + hit.distance * hit.direction;
    // Onto the plane exactly: prints are looked up there, and rays leave from there.
    const F off = Dot(normal, on_ray - vec(plane, 0));
    s.position = Select<F>(patch, on_ray - off * normal, s.position);
    s.facet = Select<F>(patch, normal, s.facet);
    s.normal = Select<F>(patch, normal, s.normal);
  }
  return s;
}

/// The frame as TracedScene describes it; `facet` comes back turned with the normal.
template <typename F>
LFM_LANE LaneFrame<F> TurnToEye(const LaneSurface<F>& s, const Vec<F>& to_eye) {
  constexpr float kGrazing = 0.02f;
  const F one = Splat<F>(1), zero = Splat<F>(0);
  const MaskOf<F> glass = s.material.kind == kLaneGlass;
  // The side of the facet that the eye is on; glass keeps its outward normal, all else turns.
  const F towards = Select(Dot(s.facet, to_eye) < 0.0f, -one, one);
  const F side = Select(glass, towards, one);
  Vec<F> n = towards * s.normal;
  const Vec<F> facet = towards * s.facet;
  const F facing = Dot(n, to_eye);
  const MaskOf<F> away = facing < kGrazing;
  if (Any(away)) n = Select<F>(away, UnitVector(n + (kGrazing - facing) * to_eye), n);
  const Vec<F> mirrored = 2.0f * Dot(n, to_eye) * n - to_eye;
  const F low = Min(0.9f * Dot(facet, to_eye), 0.01f), out = Dot(mirrored, facet);
  const MaskOf<F> mirrors = (s.material.kind != kLaneLambert) & (s.material.kind != kLaneFuzz);
  const MaskOf<F> bent = mirrors & (out < low);
  if (Any(bent)) {
    const Vec<F> lifted = UnitVector(mirrored + (low - out) * facet);
    n = Select<F>(bent, UnitVector(lifted + to_eye), n);
  }
  LaneFrame<F> frame;
  frame.z = side * n;
  frame.facet = side * facet;
  const Vec<F>& z = frame.z;
  const MaskOf<F> round = IsZero(s.along);
  const Vec<F> around = UnitOr(Vec<F>{-z.y, z.x, zero}, 1e-4f, {one, zero, zero});
  const Vec<F> t = Select<F>(round, around, s.along);
  const MaskOf<F> flat = Abs(z.z) < 0.9f;
  const Vec<F> across = UnitVector(Select<F>(flat, {z.y, -z.x, zero}, {zero, z.z, -z.y}));
  frame.x = UnitOr(t - Dot(t, z) * z, 1e-4f, across);
  frame.y = Cross(z, frame.x);
  return frame;
}

/// Where a ray that leaves a surface in `direction` starts: off the facet, by a little more than
/// float32 rounds (Waechter and Binder 2019 explain why that is needed).
template <typename F>
LFM_LANE Vec<F> DepartFrom(const Vec<F>& position, const Vec<F>& facet, const Vec<F>& direction) {
  const Vec<F> size = {Abs(position.x), Abs(position.y), Abs(position.z)};
  const F step = 1e-5f * Max(LargestOf(size), 20.0f);
  return position + Select(Dot(facet, direction) < 0.0f, -step, step) * facet;
}

}  // namespace LFM_LANE_SET
}  // namespace lfm
