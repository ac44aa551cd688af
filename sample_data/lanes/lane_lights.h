// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "sample_data/lanes/lane_math.h"
#include "sample_data/lanes/scene_tables.h"

namespace lfm {
inline namespace LFM_LANE_SET {

/// One lamp a lane: an AreaLight in float32. A lamp shines from its front; it has no back and
/// stands in nobody's way: rays see its light, and go on. Points are drawn uniformly over its area.
template <typename F>
struct LaneLamp {
  Vec<F> center, half_u, half_v, normal, radiance;
  F area, inverse_u2, inverse_v2;
};
template <typename F>
LFM_LANE LaneLamp<F> FetchLamp(const LightTables& lights, IntOf<F> index) {
  const float* from = lights.lamp;
  const Row<F> r = GatherRow(from, index * kLampFloats),
               s = GatherRow(from, index * kLampFloats + 8),
               t = GatherRow(from, index * kLampFloats + 16);
  return {{r.at[0], r.at[1], r.at[2]},
          {r.at[3], r.at[4], r.at[5]},
          {r.at[6], r.at[7], s.at[0]},
          {s.at[1], s.at[2], s.at[3]},
          {s.at[4], s.at[5], s.at[6]},
          s.at[7],
          t.at[0],
          t.at[1]};
}
template <typename F>
LFM_LANE LaneLamp<F> TheLamp(const LightTables& lights, int index) {
  const float* row = lights.lamp + index * kLampFloats;
  const auto number = [&](int i) { return Splat<F>(row[i]); };
  const auto vec = [&](int i) { return Vec<F>{number(i), number(i + 1), number(i + 2)}; };
  return {vec(0), vec(3), vec(6), vec(9), vec(12), number(15), number(16), number(17)};
}

/// A point of a lamp as seen from another point: `direction` is unit, `density` in 1/sr; 0 behind
/// the lamp.
template <typename F>
struct LampSample {
  Vec<F> direction;
  F distance, density;
};
template <typename F>
LFM_LANE LampSample<F> DrawLamp(const LaneLamp<F>& lamp, const Vec<F>& point, F u1, F u2) {
  const Vec<F> d =
      lamp.center + (2.0f * u1 - 1.0f) * lamp.half_u + (2.0f * u2 - 1.0f) * lamp.half_v - point;
  const F r2 = Dot(d, d), r = Sqrt(r2), facing = -Dot(lamp.normal, d);
  const MaskOf<F> front = facing > 0.0f;
  const F area = Select(front, facing * lamp.area, Splat<F>(1));
  return {(1.0f / r) * d, r, Select(front, r2 * r / area, Splat<F>(0))};
}
/// Distance (in lengths of the unit `direction`) at which a ray meets the front; 0 if it does not.
template <typename F>
LFM_LANE F MeetLamp(const LaneLamp<F>& lamp, const Vec<F>& origin, const Vec<F>& direction) {
  const F facing = -Dot(lamp.normal, direction), zero = Splat<F>(0);
  const Vec<F> to_center = lamp.center - origin;
  const MaskOf<F> front = facing > 0.0f;
  const F t =
      Select(front, -Dot(lamp.normal, to_center) / Select(front, facing, Splat<F>(1)), zero);
  const Vec<F> in_plane = t * direction - to_center;
  const MaskOf<F> inside = (Abs(Dot(in_plane, lamp.half_u)) * lamp.inverse_u2 <= 1.0f) &
                           (Abs(Dot(in_plane, lamp.half_v)) * lamp.inverse_v2 <= 1.0f);
  return Select(inside & (t > 0.0f), t, zero);
}
/// Density of DrawLamp in the direction of a ray that meets the front after `distance`.
template <typename F>
LFM_LANE F LampDensity(const LaneLamp<F>& lamp, const Vec<F>& direction, F distance) {
  return distance * distance / (-Dot(lamp.normal, direction) * lamp.area);
}

/// Lighting::Environment: the dim room.
template <typename F>
LFM_LANE Vec<F> RoomRadiance(const LightTables& lights, const Vec<F>& direction) {
  const F up = Clamp(direction.z, -1.0f, 1.0f), t = Abs(up);
  // Two broad, soft bright walls, so that the room is not the same all round: the sine of
  // 2 azimuth + 0.7, without the azimuth.
  const F x = direction.x, y = direction.y, planar = x * x + y * y;
  const MaskOf<F> level = planar > 1e-12f;
  const F sine = Select(level,
                        (0.764842187f * 2.0f * x * y + 0.644217687f * (x * x - y * y)) /
                            Select(level, planar, Splat<F>(1)),
                        Splat<F>(0));
  const F walls = 1.0f + 0.5f * sine * (1.0f - t);
  const MaskOf<F> above = up > 0.0f;
  const auto channel = [&](int c) {
    const F end = Select(above, Splat<F>(lights.sky[c]), Splat<F>(lights.ground[c]));
    return walls * lights.wall[c] + t * (end - lights.wall[c]);
  };
  return {channel(0), channel(1), channel(2)};
}

/// Pixel of the environment map that a unit direction points at (EnvironmentPixel).
template <typename F>
struct MapPlace {
  F x, y;
};
template <typename F>
LFM_LANE MapPlace<F> PlaceOnMap(const LightTables& lights, const Vec<F>& d) {
  const F azimuth = Atan2(d.y, d.x), polar = Atan2(Sqrt(d.x * d.x + d.y * d.y), d.z);
  return {(0.5f - azimuth * (0.5f / kLanePi)) * static_cast<float>(lights.width) - 0.5f,
          polar * (1 / kLanePi) * static_cast<float>(lights.height) - 0.5f};
}
template <typename I>
LFM_LANE I HeldIndex(I index, int count) {
  const I low = Select(index < 0, SplatInt<I>(0), index);
  return Select(low > count - 1, SplatInt<I>(count - 1), low);
}

/// EnvironmentLight::Radiance: room and map together.
template <typename F>
LFM_LANE Vec<F> EnvironmentRadiance(const LightTables& lights, const Vec<F>& direction) {
  Vec<F> radiance = Gray(Splat<F>(0));
  if (!lights.room_is_black) radiance = RoomRadiance(lights, direction);
  if (lights.pixels == nullptr) return radiance;
  const MapPlace<F> place = PlaceOnMap(lights, direction);
  const F x0 = Floor(place.x), y0 = Floor(place.y), fx = place.x - x0, fy = place.y - y0;
  const IntOf<F> column = ToInt(x0);  // -1 to width - 1
  const IntOf<F> left =
      Select(column < 0, SplatInt<IntOf<F>>(lights.width - 1), HeldIndex(column, lights.width));
  const IntOf<F> right = Select(left > lights.width - 2, SplatInt<IntOf<F>>(0), left + 1);
  const IntOf<F> top = HeldIndex(ToInt(y0), lights.height) * lights.width;
  const IntOf<F> bottom = HeldIndex(ToInt(y0) + 1, lights.height) * lights.width;
  const auto pixel = [&](IntOf<F> index) { return GatherVec<F>(lights.pixels, index * 3); };
  const Vec<F> upper = (1.0f - fx) * pixel(top + left) + fx * pixel(top + right);
  const Vec<F> lower = (1.0f - fx) * pixel(bottom + left) + fx * pixel(bottom + right);
  return radiance + Splat<F>(lights.gain) * ((1.0f - fy) * upper + fy * lower);
}

/// Density of DrawEnvironment, 1/sr; the map must be there.
template <typename F>
LFM_LANE F EnvironmentDensity(const LightTables& lights, const Vec<F>& direction) {
  const MapPlace<F> place = PlaceOnMap(lights, direction);
  const IntOf<F> x = HeldIndex(ToInt(Floor(place.x + 0.5f)), lights.width);
  const IntOf<F> y = HeldIndex(ToInt(Floor(place.y + 0.5f)), lights.height);
  return Gather(lights.density, y * lights.width + x);
}

// The interval of `count` cumulative values from `begin` on that holds `u`, and where in it.
template <typename F>
struct Interval {
  IntOf<F> index;
  F rest;
};
template <typename F>
LFM_LANE Interval<F> ChooseInterval(const float* cumulative, IntOf<F> begin, int count, F u) {
  IntOf<F> low = begin;
  for (int size = count; size > 1;) {
    const int half = size / 2;
    low = Select(Gather(cumulative, low + half) <= u, low + half, low);
    size -= half;
  }
  const F start = Gather(cumulative, low), width = Gather(cumulative, low + 1) - start;
  const F rest = (u - start) / Select(width > 0.0f, width, Splat<F>(1));
  return {low - begin, Clamp(rest, 0.0f, 0.99999994f)};
}

template <typename F>
struct EnvironmentSample {
  Vec<F> direction;
  F density;  ///< 1/sr
};
/// A direction drawn from the map, which must be there; uniform in solid angle inside a pixel.
template <typename F>
LFM_LANE EnvironmentSample<F> DrawEnvironment(const LightTables& lights, F u1, F u2) {
  const Interval<F> row = ChooseInterval<F>(lights.rows, SplatInt<IntOf<F>>(0), lights.height, u1);
  const Interval<F> column =
      ChooseInterval<F>(lights.columns, row.index * (lights.width + 1), lights.width, u2);
  const float turn = 0.5f / static_cast<float>(lights.height);  // of polar angle, a row
  F ignored, top, bottom, sine, cosine;
  SinCosTurns(ToFloat(row.index) * turn, ignored, top);
  SinCosTurns(ToFloat(row.index + 1) * turn, ignored, bottom);
  const F z = top + row.rest * (bottom - top), s = Sqrt(Max(1.0f - z * z, 0.0f));
  const F across = (ToFloat(column.index) + column.rest) / static_cast<float>(lights.width);
  SinCosTurns(0.5f - across, sine, cosine);
  return {{s * cosine, s * sine, z},
          Gather(lights.density, row.index * lights.width + column.index)};
}

}  // namespace LFM_LANE_SET
}  // namespace lfm
