// SPDX-License-Identifier: BSD-3-Clause
#include "fields/slope_fit.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "core/error.h"

namespace lfm {
namespace {

struct Points {
  std::vector<double> x, y;
};

void RequireSameSize(const std::vector<double>& x, const std::vector<double>& y) {
  if (x.size() != y.size()) throw Error("a fit needs as many abscissae as ordinates");
}

bool Counts(double value) { return std::isfinite(value) && value > 0; }

// In ascending order of area, as logarithms.
Points LogPoints(const std::vector<double>& areas, const std::vector<double>& dimensions) {
  RequireSameSize(areas, dimensions);
  std::vector<std::pair<double, double>> pairs;
  for (size_t i = 0; i < areas.size(); ++i) {
    if (Counts(areas[i]) && Counts(dimensions[i])) {
      pairs.emplace_back(std::log(areas[i]), std::log(dimensions[i]));
    }
  }
  std::sort(pairs.begin(), pairs.end());
  Points points;
  for (const auto& [x, y] : pairs) points.x.push_back(x), points.y.push_back(y);
  return points;
}

struct Line {
  double slope = 0, offset = 0;
  double squares_x = 0;     // about the mean
  double squares_left = 0;  // of what the line leaves over
};

std::optional<Line> LeastSquares(const Points& points) {
  const auto n = static_cast<double>(points.x.size());
  if (points.x.size() < 2) return std::nullopt;
  double mean_x = 0, mean_y = 0;
  for (size_t i = 0; i < points.x.size(); ++i) {
    mean_x += points.x[i] / n;
    mean_y += points.y[i] / n;
  }
  Line line;
  double products = 0;
  for (size_t i = 0; i < points.x.size(); ++i) {
    line.squares_x += (points.x[i] - mean_x) * (points.x[i] - mean_x);
    products += (points.x[i] - mean_x) * (points.y[i] - mean_y);
  }
  if (!(line.squares_x > 1e-20 * (1 + n * mean_x * mean_x))) return std::nullopt;
  line.slope = products / line.squares_x;
  line.offset = mean_y - line.slope * mean_x;
  for (size_t i = 0; i < points.x.size(); ++i) {
    const double left = points.y[i] - mean_y - line.slope * (points.x[i] - mean_x);
    line.squares_left += left * left;
  }
  return line;
}

}  // namespace

double StudentFactor95(int degrees) {
  if (degrees < 1) throw Error("Student's distribution needs a degree of freedom at least");
  constexpr double kFactors[] = {12.7062, 4.3027, 3.1824, 2.7764, 2.5706,
                                 2.4469,  2.3646, 2.3060, 2.2622, 2.2281};
  if (degrees <= static_cast<int>(std::size(kFactors))) return kFactors[degrees - 1];
  // Fisher's expansion about the normal distribution.
  const double z = 1.9599640, v = degrees, z2 = z * z;
  return z + z * (z2 + 1) / (4 * v) + z * ((5 * z2 + 16) * z2 + 3) / (96 * v * v) +
         z * (((3 * z2 + 19) * z2 + 17) * z2 - 15) / (384 * v * v * v);
}

std::optional<SlopeFit> FitSlope(const std::vector<double>& areas,
                                 const std::vector<double>& dimensions, double octaves) {
  if (!(octaves > 0)) throw Error("a slope needs a positive number of octaves");
  Points points = LogPoints(areas, dimensions);
  if (points.x.empty()) return std::nullopt;
  // Areas of whole pixels miss their octave by a little.
  const double low = points.x.back() - (octaves + 0.1) * std::log(2.0);
  const auto first = std::lower_bound(points.x.begin(), points.x.end(), low) - points.x.begin();
  points.x.erase(points.x.begin(), points.x.begin() + first);
  points.y.erase(points.y.begin(), points.y.begin() + first);
  const auto line = LeastSquares(points);
  if (!line) return std::nullopt;
  SlopeFit fit;
  fit.slope = line->slope;
  fit.points = static_cast<int>(points.x.size());
  fit.from_area = std::exp(points.x.front());
  fit.to_area = std::exp(points.x.back());
  if (fit.points > 2) {
    fit.half_width = StudentFactor95(fit.points - 2) *
                     std::sqrt(line->squares_left / (fit.points - 2) / line->squares_x);
  }
  return fit;
}

std::vector<LocalSlope> LocalSlopes(const std::vector<double>& areas,
                                    const std::vector<double>& dimensions) {
  const Points points = LogPoints(areas, dimensions);
  std::vector<LocalSlope> slopes;
  for (size_t i = 1; i < points.x.size(); ++i) {
    const double step = points.x[i] - points.x[i - 1];
    if (!(step > 1e-12)) continue;
    slopes.push_back(
        {std::exp(0.5 * (points.x[i] + points.x[i - 1])), (points.y[i] - points.y[i - 1]) / step});
  }
  return slopes;
}

std::optional<LineFit> FitLine(const std::vector<double>& x, const std::vector<double>& y) {
  RequireSameSize(x, y);
  const auto line = LeastSquares({x, y});
  if (!line) return std::nullopt;
  double squares = 0;
  for (const double value : y) squares += value * value;
  return LineFit{line->slope, line->offset,
                 squares > 0 ? std::sqrt(line->squares_left / squares) : 0};
}

}  // namespace lfm
