// SPDX-License-Identifier: BSD-3-Clause
#include "encode/view_resolution.h"

#include <Eigen/QR>
#include <algorithm>
#include <map>
#include <utility>

namespace lfm {
namespace {

constexpr int kCoarsestGrid = 4;
constexpr size_t kMostLevels = 3;

// Row i: the weights with which `from` texels along a side make texel i of `to`.
Eigen::MatrixXd Interpolation(int from, int to) {
  Eigen::MatrixXd weights = Eigen::MatrixXd::Zero(to, from);
  for (int i = 0; i < to; ++i) {
    const double x = static_cast<double>(i) * (from - 1) / (to - 1);
    const int cell = std::min(static_cast<int>(x), from - 2);
    weights(i, cell) = 1 - (x - cell);
    weights(i, cell + 1) = x - cell;
  }
  return weights;
}

// The least squares fit in both directions is that along one side, twice.
Eigen::MatrixXd AlongSide(int from, int to) {
  if (to >= from) return Interpolation(from, to);
  return Interpolation(to, from).colPivHouseholderQr().solve(Eigen::MatrixXd::Identity(from, from));
}

}  // namespace

std::vector<int> ViewGridLevels(int grid) {
  std::vector<int> levels = {grid};
  while (levels.size() < kMostLevels && levels.back() % 2 == 0 &&
         levels.back() / 2 >= kCoarsestGrid) {
    levels.push_back(levels.back() / 2);
  }
  return levels;
}

ViewResampler::ViewResampler(int from, int to)
    : from_(from), to_(to), along_side_(AlongSide(from, to).cast<float>()) {}

std::vector<float> ViewResampler::operator()(std::span<const float> values) const {
  if (from_ == to_) return {values.begin(), values.end()};
  using Strides = Eigen::Stride<Eigen::Dynamic, Eigen::Dynamic>;
  std::vector<float> result(size_t{3} * to_ * to_);
  for (int c = 0; c < 3; ++c) {
    const Eigen::Map<const Eigen::MatrixXf, 0, Strides> columns_of_x(values.data() + c, from_,
                                                                     from_, Strides(3 * from_, 3));
    Eigen::Map<Eigen::MatrixXf, 0, Strides>(result.data() + c, to_, to_, Strides(3 * to_, 3)) =
        along_side_ * columns_of_x * along_side_.transpose();
  }
  return result;
}

const ViewResampler& ResamplerBetween(int from, int to) {
  thread_local std::map<std::pair<int, int>, ViewResampler> known;
  return known.try_emplace({from, to}, from, to).first->second;
}

}  // namespace lfm
