// SPDX-License-Identifier: BSD-3-Clause
#include "calib/print_coverage.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

namespace lfm {
namespace {

constexpr double kNoBlurPx = 1e-3;
constexpr double kReachSigmas = 6;
constexpr int kTable = 1024;
constexpr int kPlaces = 20;
// Lines that run along the pixels to this ratio count as doing so.
constexpr double kAlongPixels = 1e-4;

double NormalBelow(double z) { return 0.5 * std::erfc(-z / std::numbers::sqrt2); }
double NormalDensity(double z) { return std::exp(-z * z / 2) / std::sqrt(2 * std::numbers::pi); }

// The mean of max(0, t)^power, power 1 and 2, for t normal about `t`.
double MeanRamp(double t, double sigma) {
  if (t <= -kReachSigmas * sigma) return 0;
  if (t >= kReachSigmas * sigma) return t;
  const double z = t / sigma;
  return t * NormalBelow(z) + sigma * NormalDensity(z);
}
double MeanSquaredRamp(double t, double sigma) {
  if (t <= -kReachSigmas * sigma) return 0;
  if (t >= kReachSigmas * sigma) return t * t + sigma * sigma;
  const double z = t / sigma;
  return (t * t + sigma * sigma) * NormalBelow(z) + t * sigma * NormalDensity(z);
}

double ExactShareBelow(double x, double sigma) {
  if (sigma == 0) return std::clamp(x + 0.5, 0.0, 1.0);
  return MeanRamp(x + 0.5, sigma) - MeanRamp(x - 0.5, sigma);
}

// A convex polygon of a square cut twice; room for what rounding may add.
struct CutSquare {
  std::array<Eigen::Vector2d, 8> corner = {
      Eigen::Vector2d(-0.5, -0.5), {0.5, -0.5}, {0.5, 0.5}, {-0.5, 0.5}};
  size_t count = 4;

  // Keeps what lies where row . o < distance.
  void Cut(const Eigen::Vector2d& row, double distance) {
    CutSquare kept;
    kept.count = 0;
    for (size_t i = 0; i < count; ++i) {
      const Eigen::Vector2d &a = corner[i], &b = corner[(i + 1) % count];
      const double at_a = row.dot(a) - distance, at_b = row.dot(b) - distance;
      if (at_a < 0) kept.corner[kept.count++] = a;
      if ((at_a < 0) != (at_b < 0)) {
        kept.corner[kept.count++] = a + at_a / (at_a - at_b) * (b - a);
      }
    }
    *this = kept;
  }
  double Area() const {
    double twice = 0;
    for (size_t i = 0; i < count; ++i) {
      const Eigen::Vector2d &a = corner[i], &b = corner[(i + 1) % count];
      twice += a.x() * b.y() - a.y() * b.x();
    }
    return twice / 2;
  }
};

// Where u lies for a line row . (u, v) < distance: below a bound, or above one (or anywhere, or
// nowhere, when the row has no part in u).
struct Stretch {
  double low = -std::numeric_limits<double>::infinity();
  double high = std::numeric_limits<double>::infinity();

  void Cut(double slope, double rest) {
    if (slope > 0) {
      high = std::min(high, rest / slope);
    } else if (slope < 0) {
      low = std::max(low, rest / slope);
    } else if (!(rest > 0)) {
      high = low;
    }
  }
};

// The share behind both lines. Without blur an area; else along u in closed form, place by place in
// v. What a line that runs along u cuts off ends at one v: places stand on either side of it.
double ShareBehindBoth(const PixelProfile& profile, const Eigen::Matrix2d& rows,
                       const Eigen::Vector2d& distance) {
  if (profile.blur_px() == 0) {
    CutSquare square;
    square.Cut(rows.row(0), distance(0));
    square.Cut(rows.row(1), distance(1));
    return square.Area();
  }
  const Eigen::Matrix2d size = rows.cwiseAbs();
  const int flat = size(0, 1) * size(1, 0) > size(1, 1) * size(0, 0) ? 0 : 1;
  const double split = profile.ShareBelow(distance(flat) / rows(flat, 1));
  double sum = 0;
  for (const auto& [begin, share] : {std::pair(0.0, split), std::pair(split, 1 - split)}) {
    double part = 0;
    for (int place = 0; place < kPlaces && share > 0; ++place) {
      const double v = profile.RoughQuantile(begin + share * (place + 0.5) / kPlaces);
      Stretch stretch;
      for (int line = 0; line < 2; ++line) {
        stretch.Cut(rows(line, 0), distance(line) - rows(line, 1) * v);
      }
      if (!(stretch.high > stretch.low)) continue;
      part += profile.ShareBelow(stretch.high) - profile.ShareBelow(stretch.low);
    }
    sum += share * part / kPlaces;
  }
  return sum;
}

}  // namespace

PixelProfile::PixelProfile(double blur_px)
    : blur_px_(blur_px < kNoBlurPx ? 0 : blur_px), reach_(0.5 + kReachSigmas * blur_px_) {
  for (int i = 0; i <= kTable; ++i) {
    shares_.push_back(ExactShareBelow(reach_ * (2.0 * i / kTable - 1), blur_px_));
  }
  // The shares, read the other way round.
  size_t next = 1;
  for (int i = 0; i <= kTable; ++i) {
    const double share = std::clamp(static_cast<double>(i) / kTable, 1e-6, 1 - 1e-6);
    while (next < kTable && shares_[next] < share) ++next;
    const double within = (share - shares_[next - 1]) / (shares_[next] - shares_[next - 1]);
    quantiles_.push_back(reach_ * (2 * (static_cast<double>(next) - 1 + within) / kTable - 1));
  }
}

double PixelProfile::RoughQuantile(double share) const {
  const double at = std::clamp(share, 0.0, 1.0) * kTable;
  const size_t i = std::min<size_t>(static_cast<size_t>(at), kTable - 1);
  const double within = at - static_cast<double>(i);
  return (1 - within) * quantiles_[i] + within * quantiles_[i + 1];
}

double PixelProfile::ShareBelow(double x) const {
  const double at = (x / reach_ + 1) * (kTable / 2.0);
  if (!(at > 0)) return 0;
  if (at >= kTable) return 1;
  const auto i = static_cast<size_t>(at);
  const double within = at - static_cast<double>(i);
  return (1 - within) * shares_[i] + within * shares_[i + 1];
}

double PixelProfile::Quantile(double share) const {
  if (blur_px_ == 0) return share - 0.5;
  double low = -reach_, high = reach_;
  for (int i = 0; i < 60; ++i) {
    const double x = (low + high) / 2;
    (ExactShareBelow(x, blur_px_) < share ? low : high) = x;
  }
  return (low + high) / 2;
}

// The square's sides, seen along the line's normal, are boxes of widths |row|: the share is their
// convolution's integral, a second difference of ramps; the blur is blurred ramps.
double ShareBehindLine(const PixelProfile& profile, const Eigen::Vector2d& row, double distance) {
  const double wide = row.cwiseAbs().maxCoeff(), narrow = row.cwiseAbs().minCoeff();
  if (!(wide > 0)) return distance > 0 ? 1 : 0;
  const double sigma = profile.blur_px() * row.norm();
  const double far = distance + (wide + narrow) / 2, near = distance - (wide + narrow) / 2;
  if (near >= kReachSigmas * sigma) return 1;
  if (far <= -kReachSigmas * sigma) return 0;
  const bool along = narrow < kAlongPixels * wide;
  const auto ramp = [&](double t) {
    const double up = std::max(0.0, t);
    if (along) return sigma > 0 ? MeanRamp(t, sigma) : up;
    return sigma > 0 ? MeanSquaredRamp(t, sigma) : up * up;
  };
  const double share = along ? (ramp(distance + wide / 2) - ramp(distance - wide / 2)) / wide
                             : (ramp(far) - ramp(far - wide) - ramp(far - narrow) + ramp(near)) /
                                   (2 * wide * narrow);
  return std::clamp(share, 0.0, 1.0);
}

double PixelOfCross(const PrintCross& cross, const PlateSlope& slope, const PixelProfile& profile) {
  const Eigen::Vector2d &x = cross.x_axis, y(-x.y(), x.x());
  Eigen::Matrix2d rows;
  rows.row(0) = x.transpose() * slope.mm_per_px - cross.offset_mm.x() * slope.nearing.transpose();
  rows.row(1) = y.transpose() * slope.mm_per_px - cross.offset_mm.y() * slope.nearing.transpose();
  const auto& v = cross.value;
  const double below_x = ShareBehindLine(profile, rows.row(0), cross.offset_mm.x());
  const double below_y = ShareBehindLine(profile, rows.row(1), cross.offset_mm.y());
  // value = v11 + ... in shares behind the first line, the second, and both.
  const double of_both = v[0][0] - v[0][1] - v[1][0] + v[1][1];
  double both = 0;
  if (of_both != 0) {
    const bool two = below_x > 0 && below_x < 1 && below_y > 0 && below_y < 1;
    both = two ? ShareBehindBoth(profile, rows, cross.offset_mm) : std::min(below_x, below_y);
  }
  return v[1][1] + (v[0][1] - v[1][1]) * below_x + (v[1][0] - v[1][1]) * below_y + of_both * both;
}

}  // namespace lfm
