// SPDX-License-Identifier: BSD-3-Clause
#include "calib/corner_refinement.h"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "calib/corner_template.h"
#include "core/error.h"

namespace lfm {
namespace {

constexpr int kLightTerms = 6;
constexpr int kUnknowns = kLightTerms + 2;
constexpr int kMaxIterations = 8;
// Steps shrink by a constant factor, so that the second tells the rest: what remains is an order
// less than so much of the last one.
constexpr double kConvergedPx = 3e-3, kMostShrink = 0.5;
constexpr double kFirstConvergedPx = 3e-4;
constexpr double kMaxStepPx = 1.0;
constexpr double kMaxSigmaPx = 0.25;
constexpr double kSaturated = 0.995;
// Noise of an 8-bit picture drowns less contrast than this.
constexpr double kMinContrast = 0.01;
constexpr double kMinValidShare = 0.4;

struct WindowPixel {
  Eigen::Vector2d offset;  ///< to the corner's predicted place, px
  double value = 0;
  double weight = 0;
  int index = 0;  ///< into the rendered window
};

// Pixels round a corner that carry data, weighted by a Gaussian so that far print counts less.
std::vector<WindowPixel> CollectPixels(const Image& gray, const Eigen::Vector2d& center,
                                       int radius) {
  const int x0 = static_cast<int>(std::lround(center.x()));
  const int y0 = static_cast<int>(std::lround(center.y()));
  const double inverse_variance = 1 / (0.36 * radius * radius);
  std::vector<WindowPixel> pixels;
  for (int dy = -radius; dy <= radius; ++dy) {
    for (int dx = -radius; dx <= radius; ++dx) {
      const int x = x0 + dx, y = y0 + dy;
      if (x < 0 || y < 0 || x >= gray.width() || y >= gray.height()) continue;
      const double value = gray.At<float>(x, y);
      if (!std::isfinite(value) || value >= kSaturated) continue;
      WindowPixel pixel;
      pixel.offset = Eigen::Vector2d(x, y) - center;
      pixel.value = value;
      pixel.weight = std::exp(-0.5 * inverse_variance * pixel.offset.squaredNorm());
      pixel.index = (dy + radius + 1) * (2 * radius + 3) + dx + radius + 1;
      pixels.push_back(pixel);
    }
  }
  return pixels;
}

// The window and one pixel round it, for differences.
void RenderWindow(const BoardPrint& print, const LocalView& view, const PixelFootprint& footprint,
                  const Eigen::Vector2d& shift, int radius, std::vector<double>& window) {
  const int side = 2 * radius + 3;
  window.resize(static_cast<size_t>(side) * side);
  const Eigen::Vector2d first(
      static_cast<double>(std::lround(view.pixel.x())) - radius - 1 - view.pixel.x(),
      static_cast<double>(std::lround(view.pixel.y())) - radius - 1 - view.pixel.y());
  for (int y = 0; y < side; ++y) {
    for (int x = 0; x < side; ++x) {
      window[static_cast<size_t>(y) * side + x] =
          RenderPixel(print, view, footprint, first + Eigen::Vector2d(x, y) - shift);
    }
  }
}

// A corner as the camera sees it, on the plate that it is printed on.
struct CornerView {
  const BoardPrint* print = nullptr;
  LocalView view;
};

// No answer out of the picture, or when the plate is seen from behind.
std::optional<CornerView> ViewCorner(const BoardPrint& print, int corner, const CornerPlace& place,
                                     const Camera& camera, const Pose& camera_from_world) {
  const BoardPrint::Plate plate = print.PlateOfCorner(corner);
  const Pose camera_from_plate = camera_from_world * plate.world_from_plate;
  if (camera_from_plate.Center().z() <= 0) return std::nullopt;
  const CornerPlace on_plate = {plate.plate_from_world * place.printed,
                                plate.plate_from_world * place.position, place.slope};
  const std::optional<LocalView> view = MakeLocalView(camera, camera_from_plate, on_plate);
  if (!view) return std::nullopt;
  return CornerView{plate.print, *view};
}

using LightRow = Eigen::Matrix<double, kLightTerms, 1>;
using FitRow = Eigen::Matrix<double, kUnknowns, 1>;
using FitMatrix = Eigen::Matrix<double, kUnknowns, kUnknowns>;

struct FitStep {
  Eigen::Vector2d shift;
  LightRow light;
  FitMatrix inverse;    ///< of the normal matrix
  double variance = 0;  ///< of a pixel, as the residuals say
  double relative_residual = 0;
};

struct FitPixel {
  LightRow light;
  Eigen::Vector2d template_slope;
  double value, weight;
};

std::vector<FitPixel> PairWithTemplate(const std::vector<WindowPixel>& pixels,
                                       const std::vector<double>& window, int radius) {
  const int side = 2 * radius + 3;
  std::vector<FitPixel> pairs;
  pairs.reserve(pixels.size());
  for (const WindowPixel& pixel : pixels) {
    const double t = window[pixel.index];
    const double left = window[pixel.index - 1], right = window[pixel.index + 1];
    const double above = window[pixel.index - side], below = window[pixel.index + side];
    if (std::min({t, left, right, above, below}) < 0) continue;
    const double x = pixel.offset.x() / radius, y = pixel.offset.y() / radius;
    FitPixel pair;
    pair.light << t, x * t, y * t, 1, x, y;
    pair.template_slope = {(right - left) / 2, (below - above) / 2};
    pair.value = pixel.value;
    pair.weight = pixel.weight;
    pairs.push_back(pair);
  }
  return pairs;
}

LightRow FitLight(const std::vector<FitPixel>& pixels) {
  Eigen::Matrix<double, kLightTerms, kLightTerms> normal =
      Eigen::Matrix<double, kLightTerms, kLightTerms>::Identity() * 1e-6;
  LightRow right = LightRow::Zero();
  for (const FitPixel& p : pixels) {
    normal.noalias() += p.weight * p.light * p.light.transpose();
    right += p.weight * p.value * p.light;
  }
  return normal.ldlt().solve(right);
}

FitRow RowOf(const FitPixel& p, const LightRow& light) {
  const double gain = light.head<3>().dot(p.light.tail<3>());
  FitRow row;
  row << p.light, -gain * p.template_slope;
  return row;
}

// One Gauss-Newton step over light and shift; no answer when the print has no contrast here or the
// shift is not determined.
std::optional<FitStep> SolveStep(const std::vector<FitPixel>& pixels) {
  const LightRow light = FitLight(pixels);
  FitMatrix normal = FitMatrix::Identity() * 1e-9;
  FitRow right = FitRow::Zero();
  double weights = 0, squared = 0;
  for (const FitPixel& p : pixels) {
    const double residual = p.value - light.dot(p.light);
    const FitRow row = RowOf(p, light);
    normal.noalias() += p.weight * row * row.transpose();
    right += p.weight * residual * row;
    weights += p.weight;
    squared += p.weight * residual * residual;
  }
  const double contrast = light(0);
  if (!(contrast > kMinContrast)) return std::nullopt;
  FitStep step;
  step.light = light;
  step.inverse = normal.inverse();
  step.variance = squared / weights;
  step.shift = (step.inverse * right).tail<2>();
  step.relative_residual = std::sqrt(step.variance) / contrast;
  if (!step.shift.allFinite() || !std::isfinite(step.variance)) return std::nullopt;
  return step;
}

// Covariance of the shift. The weights say how much is believed of a pixel,
// not how noisy it is: all are alike.
Eigen::Matrix2d CovarianceOfShift(const std::vector<FitPixel>& pixels, const FitStep& step) {
  FitMatrix noise = FitMatrix::Zero();
  for (const FitPixel& p : pixels) {
    const FitRow row = RowOf(p, step.light);
    noise.noalias() += p.weight * p.weight * row * row.transpose();
  }
  const FitMatrix covariance = step.variance * step.inverse * noise * step.inverse;
  const Eigen::Matrix2d of_shift = covariance.bottomRightCorner<2, 2>();
  return (of_shift + of_shift.transpose()) / 2;
}

struct CornerFit {
  CornerObservation found;
  double relative_residual = 0;
};

// Where steps lead that shrink on as the last did from the one before (Aitken).
Eigen::Vector2d RestOfSteps(const Eigen::Vector2d& before, const Eigen::Vector2d& last) {
  if (!(before.squaredNorm() > 0)) return {0, 0};
  const double shrink =
      std::clamp(last.dot(before) / before.squaredNorm(), -kMostShrink, kMostShrink);
  return last * (shrink / (1 - shrink));
}

std::optional<CornerFit> FitCorner(const Image& gray, const BoardPrint& print,
                                   const PixelFootprint& footprint, const LocalView& view,
                                   const Eigen::Vector2d& start_shift, const CornerSearch& search) {
  const int radius = search.window_radius_px;
  const std::vector<WindowPixel> pixels = CollectPixels(gray, view.pixel, radius);
  const double all_pixels = (2.0 * radius + 1) * (2.0 * radius + 1);
  Eigen::Vector2d shift = start_shift, last_step = {0, 0};
  std::vector<double> window;
  for (int iteration = 0; iteration < kMaxIterations; ++iteration) {
    RenderWindow(print, view, footprint, shift, radius, window);
    const std::vector<FitPixel> pairs = PairWithTemplate(pixels, window, radius);
    if (static_cast<double>(pairs.size()) < kMinValidShare * all_pixels) return std::nullopt;
    const std::optional<FitStep> step = SolveStep(pairs);
    if (!step) return std::nullopt;
    const double length = step->shift.norm();
    shift +=
        length > kMaxStepPx ? Eigen::Vector2d(step->shift * (kMaxStepPx / length)) : step->shift;
    if (shift.norm() > search.max_shift_px) return std::nullopt;
    // The residual belongs to the shift before the step: only a small step leaves it valid.
    if (length < (iteration == 0 ? kFirstConvergedPx : kConvergedPx) ||
        (iteration + 1 == kMaxIterations && length < 10 * kConvergedPx)) {
      const Eigen::Vector2d rest = RestOfSteps(last_step, step->shift);
      return CornerFit{{0, view.pixel + shift + rest, CovarianceOfShift(pairs, *step)},
                       step->relative_residual};
    }
    last_step = step->shift;
  }
  return std::nullopt;
}

void CheckGray(const Image& gray) {
  if (gray.channels() != 1 || gray.type() != PixelType::kFloat32 ||
      gray.encoding() != ColorEncoding::kLinear) {
    throw Error("corner search: needs one linear float channel", ErrorKind::kSystem);
  }
}

constexpr std::array<double, 10> kBlursPx = {0, 0.25, 0.4, 0.55, 0.7, 0.9, 1.2, 1.7, 2.6, 4.0};

// The least of a function with one minimum, by golden section, to an eighteenth of the interval.
template <typename Function>
double ArgMin(const Function& cost, double low, double high) {
  constexpr double kGolden = 0.6180339887498949;
  constexpr int kSteps = 6;
  double left = high - kGolden * (high - low), right = low + kGolden * (high - low);
  double at_left = cost(left), at_right = cost(right);
  for (int step = 1;; ++step) {
    if (step == kSteps) return at_left <= at_right ? (low + right) / 2 : (left + high) / 2;
    if (at_left <= at_right) {
      high = right, right = left, at_right = at_left;
      left = high - kGolden * (high - low);
      at_left = cost(left);
    } else {
      low = left, left = right, at_left = at_right;
      right = low + kGolden * (high - low);
      at_right = cost(right);
    }
  }
}

}  // namespace

Image LinearGray(const Image& picture) { return ToGray(ToLinearFloat(picture)); }

std::vector<CornerObservation> FindCorners(const Image& linear_gray, const BoardPrint& print,
                                           const std::vector<CornerPlace>& corners,
                                           const Camera& camera, const Pose& camera_from_world,
                                           const CornerSearch& search) {
  CheckGray(linear_gray);
  const PixelFootprint footprint = MakePixelFootprint(search.blur_px, search.sampling);
  std::vector<CornerObservation> found;
  for (size_t i = 0; i < corners.size(); ++i) {
    const std::optional<CornerView> corner =
        ViewCorner(print, static_cast<int>(i), corners[i], camera, camera_from_world);
    if (!corner) continue;
    const std::optional<CornerFit> fit =
        FitCorner(linear_gray, *corner->print, footprint, corner->view, {0, 0}, search);
    if (!fit || !(fit->found.SigmaPx() <= kMaxSigmaPx) ||
        fit->relative_residual > search.max_relative_residual) {
      continue;
    }
    found.push_back(fit->found);
    found.back().corner = static_cast<int>(i);
  }
  return found;
}

double EstimateBlur(const Image& linear_gray, const BoardPrint& print,
                    const std::vector<CornerPlace>& corners, const Camera& camera,
                    const Pose& camera_from_world, const std::vector<CornerObservation>& observed,
                    const CornerSearch& search) {
  CheckGray(linear_gray);
  constexpr size_t kMaxCorners = 20;
  constexpr double kCostOfNoFit = 1;
  const size_t count = std::min(kMaxCorners, observed.size());
  if (count == 0) return 0;
  const auto cost_of = [&](double blur) {
    const PixelFootprint footprint = MakePixelFootprint(blur, search.sampling);
    double cost = 0;
    for (size_t i = 0; i < count; ++i) {
      const CornerObservation& observation = observed[i * observed.size() / count];
      const std::optional<CornerView> corner = ViewCorner(
          print, observation.corner, corners[observation.corner], camera, camera_from_world);
      const std::optional<CornerFit> fit =
          corner ? FitCorner(linear_gray, *corner->print, footprint, corner->view,
                             observation.pixel - corner->view.pixel, search)
                 : std::nullopt;
      cost += fit ? std::min(kCostOfNoFit, fit->relative_residual * fit->relative_residual)
                  : kCostOfNoFit;
    }
    return cost;
  };
  std::vector<double> costs;
  size_t best = 0;
  for (const double blur : kBlursPx) {
    costs.push_back(cost_of(blur));
    if (costs.back() < costs[best]) best = costs.size() - 1;
    if (costs.size() == best + 3) break;
  }
  const size_t below = best > 0 ? best - 1 : 0, above = std::min(best + 1, kBlursPx.size() - 1);
  const double found = ArgMin(cost_of, kBlursPx[below], kBlursPx[above]);
  // A sharp picture's least is at the end.
  return best == 0 && found < kBlursPx[1] / 20 ? 0 : found;
}

Image BlurGray(const Image& linear_gray, double sigma_px) {
  CheckGray(linear_gray);
  const int reach = static_cast<int>(std::ceil(3 * sigma_px));
  std::vector<float> kernel;
  float sum = 0;
  for (int i = -reach; i <= reach; ++i) {
    kernel.push_back(static_cast<float>(std::exp(-0.5 * i * i / (sigma_px * sigma_px))));
    sum += kernel.back();
  }
  for (float& k : kernel) k /= sum;
  const int width = linear_gray.width(), height = linear_gray.height();
  Image rows(width, height, 1, PixelType::kFloat32, ColorEncoding::kLinear), blurred = rows;
  // Borders repeat. Tap by tap over whole rows, which the compiler turns into vectors.
  std::vector<float> padded(static_cast<size_t>(width) + 2 * reach);
  const auto add = [width](float weight, const float* from, float* to) {
    for (int x = 0; x < width; ++x) to[x] += weight * from[x];
  };
  for (int y = 0; y < height; ++y) {
    for (int x = -reach; x < width + reach; ++x) {
      padded[x + reach] = linear_gray.At<float>(std::clamp(x, 0, width - 1), y);
    }
    for (int i = 0; i <= 2 * reach; ++i) add(kernel[i], &padded[i], &rows.At<float>(0, y));
  }
  for (int y = 0; y < height; ++y) {
    for (int i = -reach; i <= reach; ++i) {
      add(kernel[i + reach], &rows.At<float>(0, std::clamp(y + i, 0, height - 1)),
          &blurred.At<float>(0, y));
    }
  }
  return blurred;
}

}  // namespace lfm
