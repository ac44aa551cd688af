// SPDX-License-Identifier: BSD-3-Clause
#include "resample/photo_gains.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/json_reader.h"
#include "core/parallel.h"

namespace lfm {
namespace {

using Eigen::Index;
using Basis = Eigen::Matrix<double, Eigen::Dynamic, 6>;

constexpr size_t kLeastViews = 6;      // as many as a polynomial of second degree has terms
constexpr double kDark = 0.02;         // where rounding to 8 bits is a tenth of a linear value
constexpr double kDarkest = 1e-4;      // below what 8 bits can hold
constexpr double kSmooth = 0.3;        // spread of the polynomials' terms, of log radiance
constexpr double kGainSpread = 1;      // of log gain: two and a half stops; no bound, a gauge
constexpr double kLeastScale = 0.004;  // one level in 255
constexpr double kFreedom = 3;         // of Student's t
constexpr double kLargestLog = 4.158883083359672;  // log 64

/// One triangle in one channel.
struct Comparison {
  const TriangleShades* shades = nullptr;
  Eigen::VectorXd values;   // log radiance
  Eigen::VectorXd trust;    // what rounding leaves of it
  Eigen::VectorXd weights;  // trust and robustness, in 1 / variance
  Basis basis;
  Basis projected;  // W B L^-T with L L^T = B^T W B + prior: the fit's share is projected^T
  double scale = 0.05;

  Index size() const { return values.size(); }
  uint16_t photo(Index i) const { return shades->photos[static_cast<size_t>(i)]; }
};

Comparison Compare(const TriangleShades& shades, int channel) {
  const auto count = static_cast<Index>(shades.photos.size());
  Comparison c;
  c.shades = &shades;
  c.values.resize(count);
  c.trust.resize(count);
  c.basis.resize(count, 6);
  for (Index i = 0; i < count; ++i) {
    const double radiance = std::max(kDarkest, shades.radiance[static_cast<size_t>(i)][channel]);
    const Eigen::Vector2d& d = shades.directions[static_cast<size_t>(i)];
    c.values[i] = std::log(radiance);
    c.trust[i] = std::pow(radiance / (radiance + kDark), 2);
    c.basis.row(i) << 1, d.x(), d.y(), d.x() * d.x(), d.x() * d.y(), d.y() * d.y();
  }
  return c;
}

Eigen::VectorXd WithoutGains(const Comparison& c, const Eigen::VectorXd& log_gains) {
  Eigen::VectorXd rest = c.values;
  for (Index i = 0; i < c.size(); ++i) rest[i] -= log_gains[c.photo(i)];
  return rest;
}

void PrepareFit(Comparison& c) {
  constexpr double kPrior = 1 / (kSmooth * kSmooth);
  const Basis weighted = c.weights.asDiagonal() * c.basis;
  Eigen::Matrix<double, 6, 6> normal = c.basis.transpose() * weighted;
  // The constant is free but for rounding.
  const Eigen::Vector<double, 6> prior(1e-9, kPrior, kPrior, kPrior, kPrior, kPrior);
  normal.diagonal() += prior;
  const Eigen::LLT<Eigen::Matrix<double, 6, 6>> factor(normal);
  c.projected = factor.matrixL().solve(weighted.transpose()).transpose();
}

/// W (rest - its fit), and so the normal equations' product with the smooth part eliminated.
Eigen::VectorXd WeightedResidual(const Comparison& c, const Eigen::VectorXd& rest) {
  return c.weights.cwiseProduct(rest) - c.projected * (c.projected.transpose() * rest);
}

/// Weights for the next round, from what is left of the fit.
void Reweight(Comparison& c, const Eigen::VectorXd& log_gains) {
  const Eigen::VectorXd residual =
      WeightedResidual(c, WithoutGains(c, log_gains)).cwiseQuotient(c.weights);
  const double variance = residual.cwiseAbs2().dot(c.weights) / c.weights.sum();
  c.scale = std::max(std::sqrt(variance), kLeastScale);
  const Eigen::ArrayXd spread = c.scale * c.scale + residual.array().square() / kFreedom;
  c.weights = (c.trust.array() / spread).matrix();
}

void StartWeights(Comparison& c) { c.weights = c.trust / (c.scale * c.scale); }

/// Solves for the log gains by conjugate gradients from where they stand, preconditioned by the
/// diagonal.
Eigen::VectorXd SolveGains(const std::vector<Comparison>& comparisons, Eigen::VectorXd gains) {
  constexpr int kMostSteps = 200;
  constexpr double kTolerance = 1e-6;
  constexpr double kPrior = 1 / (kGainSpread * kGainSpread);
  Eigen::VectorXd diagonal = Eigen::VectorXd::Constant(gains.size(), kPrior);
  Eigen::VectorXd right = Eigen::VectorXd::Zero(gains.size());
  for (const Comparison& c : comparisons) {
    const Eigen::VectorXd residual = WeightedResidual(c, c.values);
    for (Index i = 0; i < c.size(); ++i) {
      right[c.photo(i)] += residual[i];
      diagonal[c.photo(i)] += c.weights[i] - c.projected.row(i).squaredNorm();
    }
  }
  const auto multiply = [&](const Eigen::VectorXd& x) {
    Eigen::VectorXd y = kPrior * x;
    for (const Comparison& c : comparisons) {
      Eigen::VectorXd mine(c.size());
      for (Index i = 0; i < c.size(); ++i) mine[i] = x[c.photo(i)];
      const Eigen::VectorXd product = WeightedResidual(c, mine);
      for (Index i = 0; i < c.size(); ++i) y[c.photo(i)] += product[i];
    }
    return y;
  };
  Eigen::VectorXd residual = right - multiply(gains);
  Eigen::VectorXd scaled = residual.cwiseQuotient(diagonal), along = scaled;
  double energy = residual.dot(scaled);
  const double enough = kTolerance * kTolerance * right.dot(right.cwiseQuotient(diagonal));
  for (int step = 0; step < kMostSteps && energy > enough; ++step) {
    const Eigen::VectorXd product = multiply(along);
    const double length = energy / along.dot(product);
    gains += length * along;
    residual -= length * product;
    scaled = residual.cwiseQuotient(diagonal);
    const double next = residual.dot(scaled);
    along = scaled + next / energy * along;
    energy = next;
  }
  return gains;
}

/// Rounds of weights and gains over the triangles of one half (or all).
Eigen::VectorXd FitGains(std::vector<Comparison>& comparisons, Index photo_count) {
  constexpr int kRounds = 6;
  Eigen::VectorXd gains = Eigen::VectorXd::Zero(photo_count);
  for (Comparison& c : comparisons) StartWeights(c);
  for (int round = 0; round < kRounds; ++round) {
    for (Comparison& c : comparisons) {
      PrepareFit(c);
      if (round == 0) continue;
      Reweight(c, gains);
      PrepareFit(c);
    }
    gains = SolveGains(comparisons, std::move(gains));
  }
  return gains.cwiseMax(-kLargestLog).cwiseMin(kLargestLog);
}

/// What a triangle that was not fitted says of gains: the RMS distance from its smooth function.
double ErrorOf(Comparison c, const Eigen::VectorXd& log_gains) {
  constexpr int kRounds = 3;
  c.scale = 0.05;
  StartWeights(c);
  for (int round = 0; round < kRounds; ++round) {
    PrepareFit(c);
    Reweight(c, log_gains);
  }
  return c.scale;
}

double MedianError(const std::vector<Comparison>& comparisons, const Eigen::VectorXd& log_gains) {
  std::vector<double> errors;
  for (const Comparison& c : comparisons) errors.push_back(ErrorOf(c, log_gains));
  if (errors.empty()) return 0;
  const auto middle = errors.begin() + static_cast<std::ptrdiff_t>(errors.size() / 2);
  std::nth_element(errors.begin(), middle, errors.end());
  return *middle;
}

/// Mean zero over the photographs that were compared, zero for the others.
void SetGauge(const std::vector<TriangleShades>& shades, Eigen::VectorXd& log_gains) {
  std::vector<bool> compared(static_cast<size_t>(log_gains.size()), false);
  for (const TriangleShades& s : shades) {
    if (s.photos.size() < kLeastViews) continue;
    for (const uint16_t p : s.photos) compared[p] = true;
  }
  double sum = 0, count = 0;
  for (Index p = 0; p < log_gains.size(); ++p) {
    if (!compared[static_cast<size_t>(p)]) continue;
    sum += log_gains[p];
    count += 1;
  }
  for (Index p = 0; p < log_gains.size(); ++p) {
    log_gains[p] = compared[static_cast<size_t>(p)] ? log_gains[p] - sum / count : 0;
  }
}

struct ChannelGains {
  Eigen::VectorXd log_gains;
  double error_without = 0, error_with = 0;
};

ChannelGains EstimateChannel(const std::vector<TriangleShades>& shades, int channel, Index photos) {
  std::vector<Comparison> all;
  std::array<std::vector<Comparison>, 2> halves;
  for (const TriangleShades& s : shades) {
    if (s.photos.size() < kLeastViews) continue;
    all.push_back(Compare(s, channel));
    halves[all.size() % 2].push_back(all.back());
  }
  ChannelGains result;
  result.error_without = MedianError(halves[1], Eigen::VectorXd::Zero(photos));
  result.error_with = MedianError(halves[1], FitGains(halves[0], photos));
  result.log_gains = FitGains(all, photos);
  SetGauge(shades, result.log_gains);
  return result;
}

}  // namespace

PhotoGains EstimatePhotoGains(const std::vector<TriangleShades>& shades, size_t photo_count) {
  const auto photos = static_cast<Index>(photo_count);
  PhotoGains result;
  result.gains.assign(photo_count, Eigen::Vector3d::Ones());
  for (const TriangleShades& s : shades) {
    result.triangles += s.photos.size() >= kLeastViews ? 1 : 0;
  }
  if (photo_count < 2 || result.triangles < 2) return result;
  std::array<ChannelGains, 3> channels;
  ParallelFor(0, 3, [&](int64_t c) {
    channels[static_cast<size_t>(c)] = EstimateChannel(shades, static_cast<int>(c), photos);
  });
  for (int c = 0; c < 3; ++c) {
    const ChannelGains& channel = channels[static_cast<size_t>(c)];
    result.error_without += channel.error_without / 3;
    result.error_with += channel.error_with / 3;
    for (Index p = 0; p < photos; ++p) {
      result.gains[static_cast<size_t>(p)][c] = std::exp(channel.log_gains[p]);
    }
  }
  return result;
}

double ExposureSpreadStops(const std::vector<Eigen::Vector3d>& gains) {
  double sum = 0, squares = 0;
  for (const Eigen::Vector3d& gain : gains) {
    const double stops = std::log2(gain.y());
    sum += stops;
    squares += stops * stops;
  }
  const auto count = static_cast<double>(std::max<size_t>(gains.size(), 1));
  return std::sqrt(std::max(0.0, squares / count - sum / count * (sum / count)));
}

void SavePhotoGains(const std::vector<std::string>& photo_ids,
                    const std::vector<Eigen::Vector3d>& applied,
                    const std::filesystem::path& folder) {
  nlohmann::json photos = nlohmann::json::array();
  for (size_t p = 0; p < applied.size(); ++p) {
    photos.push_back(
        {{"id", photo_ids[p]}, {"gains", {applied[p].x(), applied[p].y(), applied[p].z()}}});
  }
  WriteJson({{"applied", !applied.empty()}, {"photos", photos}}, folder / "photo_gains.json");
}

}  // namespace lfm
