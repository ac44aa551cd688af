// SPDX-License-Identifier: BSD-3-Clause
#include "sample_data/shapes/shape_parameters.h"

#include <algorithm>
#include <sstream>

namespace lfm {
namespace {

constexpr double kSmallestEdge = 0.05, kLargestEdge = 1e4;

}  // namespace

double ShapeParameters::InRange(const std::string& key, double value, double min,
                                double max) const {
  if (!(value >= min && value <= max)) {
    std::ostringstream text;
    text << "expected a number between " << min << " and " << max;
    reader_->Fail(key, text.str());
  }
  return value;
}

double ShapeParameters::Number(const std::string& key, double otherwise, double min, double max) {
  return InRange(key, reader_->NumberOr(key, otherwise), min, max);
}

int ShapeParameters::Integer(const std::string& key, int otherwise, int min, int max) {
  return reader_->Has(key) ? reader_->Integer(key, min, max) : otherwise;
}

int ShapeParameters::Choice(const std::string& key, const std::vector<std::string>& words,
                            int otherwise) {
  const std::string word = reader_->TextOr(key, words[otherwise]);
  const auto found = std::find(words.begin(), words.end(), word);
  if (found == words.end()) {
    std::string all;
    for (const std::string& w : words) all += (all.empty() ? "" : ", ") + w;
    reader_->Fail(key, "'" + word + "' is none of " + all);
  }
  return static_cast<int>(found - words.begin());
}

Eigen::Vector3d ShapeParameters::Vector(const std::string& key, const Eigen::Vector3d& otherwise,
                                        double min, double max) {
  if (!reader_->Has(key)) return otherwise;
  const std::vector<double> v = reader_->Numbers(key, 3);
  for (const double value : v) InRange(key, value, min, max);
  return {v[0], v[1], v[2]};
}

std::vector<Eigen::Vector2d> ShapeParameters::Points(const std::string& key) {
  std::vector<Eigen::Vector2d> points;
  if (!reader_->Has(key)) return points;
  for (const std::vector<double>& row : reader_->NumberRows(key, 2)) {
    InRange(key, row[0], 0, 1e4);
    InRange(key, row[1], -1e4, 1e4);
    points.emplace_back(row[0], row[1]);
  }
  return points;
}

double ShapeParameters::Edge(double otherwise, double tiny) {
  const double edge = Number("edge_mm", otherwise, kSmallestEdge, kLargestEdge);
  const double coarse = Number("tiny_edge_mm", std::max(tiny, edge), kSmallestEdge, kLargestEdge);
  return detail_ == SceneDetail::kTiny ? coarse : edge;
}

}  // namespace lfm
