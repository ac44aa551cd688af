// SPDX-License-Identifier: BSD-3-Clause
#include "calib/circle_detection.h"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>

namespace lfm {
namespace {

using V3f = Eigen::Vector3f;

constexpr int kMaxSide = 1600;
constexpr double kWhitePercentile = 0.95;
constexpr float kMinSaturation = 0.5f, kMinLevel = 0.06f, kMaxPaperSaturation = 0.35f;
constexpr int kMinArea = 20;
constexpr double kMaxAreaShare = 0.1;
constexpr double kMinMinorRadiusPx = 2.5, kMinAspect = 0.12;
constexpr double kMinOverlap = 0.8;
// Between the disc's edge and the end of the paper round it (board_validation.cpp).
constexpr double kRingRadii = 1.33;
constexpr int kRingSamples = 48;
constexpr double kMaxHueError_deg = 20;
constexpr size_t kMaxCircles = 200;

struct LinearPicture {
  int width = 0, height = 0;
  double factor = 1;        // pixels of the original along the side of one of these
  std::vector<V3f> pixels;  // linear; white is (1, 1, 1)
  const V3f& At(int x, int y) const { return pixels[static_cast<size_t>(y) * width + x]; }
};

V3f WhiteOf(const std::vector<V3f>& pixels) {
  V3f white;
  std::vector<float> values(pixels.size());
  for (int c = 0; c < 3; ++c) {
    for (size_t i = 0; i < pixels.size(); ++i) values[i] = pixels[i][c];
    const auto at = values.begin() + static_cast<std::ptrdiff_t>(
                                         kWhitePercentile * static_cast<double>(values.size() - 1));
    std::nth_element(values.begin(), at, values.end());
    white[c] = *at;
  }
  return white;
}

// Averaged to at most kMaxSide pixels a side and divided by its white.
std::optional<LinearPicture> Normalize(const Image& picture) {
  const Image linear = ToLinearFloat(picture);
  const int factor = (std::max(picture.width(), picture.height()) + kMaxSide - 1) / kMaxSide;
  LinearPicture small;
  small.width = picture.width() / factor;
  small.height = picture.height() / factor;
  small.factor = factor;
  if (small.width < 8 || small.height < 8) return std::nullopt;
  small.pixels.resize(static_cast<size_t>(small.width) * small.height, V3f::Zero());
  for (int y = 0; y < small.height; ++y) {
    for (int x = 0; x < small.width; ++x) {
      V3f sum = V3f::Zero();
      for (int i = 0; i < factor * factor; ++i) {
        const float* p = &linear.At<float>(x * factor + i % factor, y * factor + i / factor);
        sum += V3f(p[0], p[1], p[2]);
      }
      V3f& mean = small.pixels[static_cast<size_t>(y) * small.width + x];
      mean = sum / static_cast<float>(factor * factor);
      if (!mean.allFinite()) mean.setZero();
    }
  }
  const V3f white = WhiteOf(small.pixels);
  if (!(white.minCoeff() > 1e-5f)) return std::nullopt;
  for (V3f& p : small.pixels) p = p.cwiseQuotient(white);
  return small;
}

float Saturation(const V3f& color) {
  const float most = color.maxCoeff();
  return most > 0 ? (most - std::max(0.0f, color.minCoeff())) / most : 0;
}

double HueDegrees(const V3f& color) {
  // The angle round the gray axis.
  const double alpha = color.x() - 0.5 * (color.y() + color.z());
  const double beta = std::numbers::sqrt3 / 2 * (color.y() - color.z());
  return std::atan2(beta, alpha) / std::numbers::pi * 180;
}

std::optional<CircleColor> Classify(const V3f& reflectance) {
  if (Saturation(reflectance) < kMinSaturation) return std::nullopt;
  double nearest = kMaxHueError_deg;
  std::optional<CircleColor> color;
  for (int i = 0; i < kCircleColors; ++i) {
    const auto candidate = static_cast<CircleColor>(i);
    const double error = std::abs(
        std::remainder(HueDegrees(reflectance) - HueDegrees(CircleReflectance(candidate)), 360.0));
    if (error < nearest) {
      nearest = error;
      color = candidate;
    }
  }
  return color;
}

// First and second moments of weighted pixels.
struct Moments {
  double weight = 0;
  Eigen::Vector2d sum = {0, 0};
  Eigen::Matrix2d squares = Eigen::Matrix2d::Zero();

  void Add(int x, int y, double w) {
    const Eigen::Vector2d p(x, y);
    weight += w;
    sum += w * p;
    squares += w * p * p.transpose();
  }
  Eigen::Vector2d Center() const { return sum / weight; }
  // A uniform ellipse has a quarter of its squared radii as covariance.
  Eigen::Matrix2d Shape() const { return 4 * (squares / weight - Center() * Center().transpose()); }
};

bool IsRound(const Eigen::Matrix2d& shape) {
  const Eigen::Vector2d squared_radii =
      Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d>(shape).eigenvalues();
  return squared_radii.allFinite() && squared_radii[0] >= kMinMinorRadiusPx * kMinMinorRadiusPx &&
         squared_radii[0] >= kMinAspect * kMinAspect * squared_radii[1];
}

// Pixels (x, y, squared radius) within `radii` times an ellipse.
template <typename Visit>
void VisitEllipse(const LinearPicture& picture, const Eigen::Vector2d& center,
                  const Eigen::Matrix2d& shape, double radii, const Visit& visit) {
  const Eigen::Matrix2d inverse = shape.inverse();
  const Eigen::Vector2d reach = radii * shape.diagonal().cwiseSqrt();
  const int x0 = std::max(0, static_cast<int>(std::ceil(center.x() - reach.x())));
  const int y0 = std::max(0, static_cast<int>(std::ceil(center.y() - reach.y())));
  const int x1 = std::min(picture.width - 1, static_cast<int>(center.x() + reach.x()));
  const int y1 = std::min(picture.height - 1, static_cast<int>(center.y() + reach.y()));
  for (int y = y0; y <= y1; ++y) {
    for (int x = x0; x <= x1; ++x) {
      const Eigen::Vector2d d = Eigen::Vector2d(x, y) - center;
      const double squared = d.dot(inverse * d);
      if (squared <= radii * radii) visit(x, y, squared);
    }
  }
}

V3f MeanInside(const LinearPicture& picture, const Eigen::Vector2d& center,
               const Eigen::Matrix2d& shape) {
  V3f sum = V3f::Zero();
  int count = 0;
  VisitEllipse(picture, center, shape, 0.6, [&](int x, int y, double) {
    sum += picture.At(x, y);
    ++count;
  });
  return count > 0 ? V3f(sum / static_cast<float>(count)) : V3f::Zero();
}

// The paper round a disc: the median of a ring; no answer when a third of it is out of the picture.
std::optional<V3f> PaperAround(const LinearPicture& picture, const Eigen::Vector2d& center,
                               const Eigen::Matrix2d& shape) {
  const Eigen::Matrix2d radii = kRingRadii * Eigen::Matrix2d(shape.llt().matrixL());
  std::array<std::vector<float>, 3> values;
  for (int i = 0; i < kRingSamples; ++i) {
    const double angle = 2 * std::numbers::pi * i / kRingSamples;
    const Eigen::Vector2d p = center + radii * Eigen::Vector2d(std::cos(angle), std::sin(angle));
    const int x = static_cast<int>(std::lround(p.x())), y = static_cast<int>(std::lround(p.y()));
    if (x < 0 || y < 0 || x >= picture.width || y >= picture.height) continue;
    for (int c = 0; c < 3; ++c) values[c].push_back(picture.At(x, y)[c]);
  }
  if (values[0].size() * 3 < kRingSamples * 2) return std::nullopt;
  V3f median;
  for (int c = 0; c < 3; ++c) {
    const auto middle = values[c].begin() + static_cast<std::ptrdiff_t>(values[c].size() / 2);
    std::nth_element(values[c].begin(), middle, values[c].end());
    median[c] = *middle;
  }
  return median;
}

std::optional<DetectedCircle> MeasureCircle(const LinearPicture& picture, const Moments& region) {
  const Eigen::Vector2d center = region.Center();
  const Eigen::Matrix2d shape = region.Shape();
  if (!IsRound(shape)) return std::nullopt;
  const std::optional<V3f> paper = PaperAround(picture, center, shape);
  if (!paper || paper->minCoeff() <= 0 || Saturation(*paper) > kMaxPaperSaturation) {
    return std::nullopt;
  }
  const V3f ink = MeanInside(picture, center, shape);
  if (ink.sum() >= paper->sum()) return std::nullopt;
  const std::optional<CircleColor> color = Classify(ink.cwiseQuotient(*paper));
  if (!color) return std::nullopt;
  // Coverage: 0 on paper, 1 on ink. The centroid of linear light is not moved by blur.
  const V3f change = ink - *paper;
  Moments coverage;
  VisitEllipse(picture, center, shape, kRingRadii, [&](int x, int y, double) {
    const float share = (picture.At(x, y) - *paper).dot(change) / change.squaredNorm();
    if (share > 0.1f) coverage.Add(x, y, std::min(share, 1.0f));
  });
  if (coverage.weight < kMinArea || !IsRound(coverage.Shape())) return std::nullopt;
  DetectedCircle circle;
  circle.center = ((coverage.Center().array() + 0.5) * picture.factor - 0.5).matrix();
  circle.shape = coverage.Shape() * picture.factor * picture.factor;
  circle.color = *color;
  return circle;
}

// A region that fills the ellipse of its own moments.
bool FillsItsEllipse(const LinearPicture& picture, const Moments& region,
                     const std::vector<int>& labels, int label) {
  const Eigen::Matrix2d shape = region.Shape();
  if (!IsRound(shape)) return false;
  double inside = 0, both = 0;
  VisitEllipse(picture, region.Center(), shape, 1, [&](int x, int y, double) {
    ++inside;
    if (labels[static_cast<size_t>(y) * picture.width + x] == label) ++both;
  });
  return both >= kMinOverlap * (inside + region.weight - both);
}

// Connected coloured pixels (four neighbours) are given one label; returns the regions' moments.
std::vector<Moments> LabelRegions(const LinearPicture& picture, std::vector<int>& labels) {
  constexpr int kUnlabelled = -1, kPlain = -2;
  labels.resize(picture.pixels.size());
  for (size_t i = 0; i < labels.size(); ++i) {
    const V3f& p = picture.pixels[i];
    const bool colored = p.maxCoeff() > kMinLevel && Saturation(p) > kMinSaturation;
    labels[i] = colored ? kUnlabelled : kPlain;
  }
  std::vector<Moments> regions;
  std::vector<int> stack;
  for (size_t start = 0; start < labels.size(); ++start) {
    if (labels[start] != kUnlabelled) continue;
    Moments region;
    const int label = static_cast<int>(regions.size());
    labels[start] = label;
    stack.push_back(static_cast<int>(start));
    while (!stack.empty()) {
      const int i = stack.back(), x = i % picture.width, y = i / picture.width;
      stack.pop_back();
      region.Add(x, y, 1);
      const auto visit = [&](bool exists, int neighbour) {
        if (!exists || labels[static_cast<size_t>(neighbour)] != kUnlabelled) return;
        labels[static_cast<size_t>(neighbour)] = label;
        stack.push_back(neighbour);
      };
      visit(x > 0, i - 1);
      visit(x + 1 < picture.width, i + 1);
      visit(y > 0, i - picture.width);
      visit(y + 1 < picture.height, i + picture.width);
    }
    regions.push_back(region);
  }
  return regions;
}

}  // namespace

std::vector<DetectedCircle> DetectCircles(const Image& picture) {
  if (picture.channels() < 3) return {};
  const std::optional<LinearPicture> linear = Normalize(picture);
  if (!linear) return {};
  std::vector<int> labels;
  const std::vector<Moments> regions = LabelRegions(*linear, labels);
  const double max_area = kMaxAreaShare * static_cast<double>(labels.size());
  std::vector<DetectedCircle> circles;
  for (size_t i = 0; i < regions.size(); ++i) {
    if (regions[i].weight < kMinArea || regions[i].weight > max_area) continue;
    if (!FillsItsEllipse(*linear, regions[i], labels, static_cast<int>(i))) continue;
    if (const auto circle = MeasureCircle(*linear, regions[i])) circles.push_back(*circle);
  }
  if (circles.size() > kMaxCircles) {
    std::stable_sort(circles.begin(), circles.end(),
                     [](const DetectedCircle& a, const DetectedCircle& b) {
                       return a.shape.determinant() > b.shape.determinant();
                     });
    circles.resize(kMaxCircles);
  }
  return circles;
}

}  // namespace lfm
