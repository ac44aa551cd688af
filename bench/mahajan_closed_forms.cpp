// SPDX-License-Identifier: BSD-3-Clause
// Mahajan 2007, Figures 7b to 7f: pictures whose light transport has a closed form, lit from a few
// thousand directions spread evenly over the sphere.
#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

#include "bench/mahajan_report.h"
#include "core/formatted_text.h"
#include "core/parallel.h"
#include "fields/dimension.h"
#include "fields/patches.h"

namespace lfm {
namespace {

using V3d = Eigen::Vector3d;
constexpr double kPi = std::numbers::pi, kShare = 0.9995;

// The eye looks down from +z, from afar. x to the right, y up.
struct Scene {
  std::string name;
  std::function<bool(double x, double y)> inside;
  std::function<double(double x, double y, const V3d& light)> transport;
};

// Pixels about a place, so many that the largest patch fits. A pixel has to be finer than the
// lights lie apart: else every pixel is its own and dimensions grow with the area, whatever the
// scene.
struct View {
  double reach = 0.35;  ///< radius of the largest patch
  int lights = 6144;    ///< as many as 6 x 32 x 32 texels
};
constexpr int kSide = 40, kMaxArea = 1024;

std::vector<V3d> EvenDirections(int count) {
  std::vector<V3d> directions;
  for (int i = 0; i < count; ++i) {
    const double z = 1 - (2 * i + 1.0) / count, r = std::sqrt(1 - z * z);
    const double turn = kPi * (3 - std::sqrt(5.0)) * i;
    directions.emplace_back(r * std::cos(turn), r * std::sin(turn), z);
  }
  return directions;
}

ChartCurve CurveAbout(const Scene& scene, double center_x, double center_y, const View& view,
                      const std::string& name) {
  const double spacing = view.reach / std::sqrt(kMaxArea / kPi);
  const auto x_of = [&](int64_t i) {
    return center_x + spacing * static_cast<double>(i % kSide - kSide / 2);
  };
  const auto y_of = [&](int64_t i) {
    return center_y - spacing * static_cast<double>(i / kSide - kSide / 2);
  };
  std::vector<uint8_t> occupied;
  for (int64_t i = 0; i < kSide * kSide; ++i) occupied.push_back(scene.inside(x_of(i), y_of(i)));
  const NestedPatches patches = PixelPatches(kSide, kSide, occupied, kSide / 2 * kSide + kSide / 2,
                                             PatchShape::kDisc, {16, kMaxArea, 2});
  const std::vector<V3d> lights = EvenDirections(view.lights);
  FunctionRows rows = MakeFunctionRows(static_cast<int64_t>(patches.points.size()), view.lights);
  ParallelFor(0, rows.rows, [&](int64_t i) {
    const double x = x_of(patches.points[i]), y = y_of(patches.points[i]);
    for (int j = 0; j < view.lights; ++j) {
      rows.Row(i)[j] = static_cast<float>(scene.transport(x, y, lights[j]));
    }
  });
  ChartCurve curve{name, {}, {}};
  int expected = 0;
  for (const int64_t size : patches.sizes) {
    expected = DimensionOf(RowsView{rows.values.data(), size, rows.columns, rows.stride}, kShare,
                           expected);
    curve.x.push_back(static_cast<double>(size));
    curve.y.push_back(expected);
  }
  return curve;
}

std::optional<SlopeFit> SlopeOf(const ChartCurve& curve) { return FitSlope(curve.x, curve.y); }

void Draw(const std::string& name, const std::string& title, const std::vector<ChartCurve>& curves,
          MahajanReport& report) {
  report.Draw(name, {title + ": 99.95 % of the energy", "pixels of the patch", "terms",
                     ChartScale::kLogarithmic, curves, ChartScale::kLogarithmic});
}

bool InDisc(double x, double y) { return x * x + y * y < 0.9999; }

double PhongOf(const V3d& normal, const V3d& light, double exponent) {
  const V3d mirrored = 2 * normal.z() * normal - V3d::UnitZ();
  return std::pow(std::max(mirrored.dot(light), 0.0), exponent);
}

// Semi-axes `length`, 1 and 1; without end: a cylinder.
Scene Ellipsoid(double length, double exponent) {
  return {"ellipsoid",
          [=](double x, double y) { return x * x / (length * length) + y * y < 0.9999; },
          [=](double x, double y, const V3d& light) {
            const double z = std::sqrt(1 - x * x / (length * length) - y * y);
            return PhongOf(V3d(x / (length * length), y, z).normalized(), light, exponent);
          }};
}

// The inside of half a unit sphere; what `shade` makes of normal and light where light comes in.
Scene Bowl(std::function<double(const V3d& normal, const V3d& light)> shade) {
  return {"bowl", InDisc, [shade = std::move(shade)](double x, double y, const V3d& light) {
            const V3d normal(-x, -y, std::sqrt(1 - x * x - y * y));
            const double cosine = normal.dot(light);
            // Where the ray leaves the sphere.
            const double exit_z = -normal.z() + 2 * cosine * light.z();
            return cosine > 0 && exit_z > 0 ? shade(normal, light) : 0.0;
          }};
}

// A floor beside a wall of height 1 whose edge, along y, stands at x = -1.5.
Scene Step() {
  return {"step", [](double, double) { return true; },
          [](double x, double, const V3d& light) {
            if (light.z() <= 0) return 0.0;
            return light.x() < 0 && light.z() * (x + 1.5) < -light.x() ? 0.0 : 1.0;
          }};
}

enum class Grid { kAlongX, kBoth };

// A floor below a layer of `count` flat blockers (a side), half of each pitch covered.
Scene Blockers(Grid grid, int count, double pitch, double height) {
  const auto covered = [=](double at) {
    const double place = at / pitch + count / 2.0;
    return place > 0 && place < count && place - std::floor(place) < 0.5;
  };
  return {"blockers", [](double, double) { return true; },
          [=](double x, double y, const V3d& light) {
            if (light.z() <= 0) return 0.0;
            const bool in_x = covered(x + height * light.x() / light.z());
            const bool in_y = grid == Grid::kAlongX || covered(y + height * light.y() / light.z());
            return in_x && in_y ? 0.0 : 1.0;
          }};
}

void DrawConvex(MahajanReport& report) {
  std::vector<ChartCurve> centers;
  for (const double at : {0.0, 0.3, 0.6, 0.99}) {
    const bool rim = at > 0.9;
    const ChartCurve curve = CurveAbout(Ellipsoid(1, 500), at, 0, {rim ? 0.06 : 0.375},
                                        FormattedText("%g of the radius", at));
    if (rim) {
      report.AddSlope("Figure 7b: at the rim, Phong s = 500", SlopeOf(curve), 0.4, 0.6);
    } else {
      report.AddSlope(FormattedText("Figure 7b: centre at %g of the radius, s = 500", at),
                      SlopeOf(curve), 0.9, 9);
    }
    centers.push_back(curve);
  }
  Draw("figure7b", "Convex hemisphere, Phong s = 500, patches off the middle", centers, report);
  std::vector<ChartCurve> curvatures;
  for (const double length : {1.0, 2.0, 4.0, 1e6}) {
    const bool cylinder = length > 1000;
    const std::string name = cylinder ? "cylinder" : FormattedText("semi-axes 1 : %g", 1 / length);
    curvatures.push_back(CurveAbout(Ellipsoid(length, 500), 0, 0, {0.375}, name));
    if (cylinder) {
      report.AddSlope("Figure 7c: cylinder, Phong s = 500", SlopeOf(curvatures.back()), 0.4, 0.6);
    } else {
      report.Note("Figure 7c: ellipsoid, " + name, SlopeText(SlopeOf(curvatures.back())));
    }
  }
  Draw("figure7c", "Ellipsoids, Phong s = 500", curvatures, report);
}

void DrawShadows(MahajanReport& report) {
  std::vector<ChartCurve> curves;
  constexpr double kFine = 0.08;  // in which the rim's shadow crosses two texels
  const Scene open = Bowl([](const V3d&, const V3d&) { return 1.0; });
  for (const double at : {0.0, 0.4, 0.7}) {
    curves.push_back(CurveAbout(open, at, 0, {kFine}, FormattedText("concave, at %g", at)));
    report.AddSlope(FormattedText("Figure 7d: concave visibility about %g of the radius", at),
                    SlopeOf(curves.back()), 0.4, 0.6);
  }
  for (const double reach : {0.15, 0.35}) {
    report.Note(
        FormattedText("the same about the middle, pixels %.1f times as coarse", reach / kFine),
        SlopeText(SlopeOf(CurveAbout(open, 0, 0, {reach}, ""))));
  }
  curves.push_back(CurveAbout(Step(), 0, 0, {0.75}, "step"));
  report.AddSlope("Figure 7d: step in 3D", SlopeOf(curves.back()), 0.4, 0.6);
  for (const int lights : {1536, 24576}) {
    report.Note(FormattedText("the same from %d instead of 6144 directions", lights),
                SlopeText(SlopeOf(CurveAbout(Step(), 0, 0, {0.75, lights}, ""))));
  }
  Draw("figure7d", "Visibility of a concave hemisphere and a step", curves, report);
  std::vector<ChartCurve> grids = {
      CurveAbout(Blockers(Grid::kAlongX, 15, 0.3, 0.5), 0, 0, {0.75}, "1D grid"),
      CurveAbout(Blockers(Grid::kBoth, 15, 0.3, 0.5), 0, 0, {0.75}, "2D grid")};
  report.AddSlope("Figure 7e: 1D grid of blockers", SlopeOf(grids[0]), 0.4, 0.6);
  report.AddSlope("Figure 7e: 2D grid of blockers", SlopeOf(grids[1]), 0.85, 9);
  Draw("figure7e", "Grids of blockers", grids, report);
}

void DrawConcave(MahajanReport& report) {
  std::vector<ChartCurve> curves = {
      CurveAbout(Bowl([](const V3d& n, const V3d& l) { return n.dot(l); }), 0.3, 0, {}, "diffuse")};
  report.AddSlope("Figure 7f: concave, diffuse", SlopeOf(curves.back()), 0.4, 0.6);
  for (const double exponent : {50.0, 100.0, 500.0}) {
    curves.push_back(
        CurveAbout(Bowl([=](const V3d& n, const V3d& l) { return PhongOf(n, l, exponent); }), 0.3,
                   0, {}, FormattedText("Phong s = %g", exponent)));
    report.AddSlope("Figure 7f: concave, " + curves.back().name, SlopeOf(curves.back()), 0.7, 0.9);
  }
  Draw("figure7f", "Concave hemisphere, without interreflection", curves, report);
}

}  // namespace

void DrawClosedForms(MahajanReport& report) {
  DrawConvex(report);
  DrawShadows(report);
  DrawConcave(report);
}

}  // namespace lfm
