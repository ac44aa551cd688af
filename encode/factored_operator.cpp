// SPDX-License-Identifier: BSD-3-Clause
#include "encode/factored_operator.h"

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "encode/product_kernels.h"
#include "encode/shared_samples.h"

namespace lfm {
namespace {

constexpr int kChannels = 3;
constexpr int kPanel = 16;  // columns of a Gram matrix that are multiplied at once

// Zero weights (corners of the hull, repeated views) are left out here: fewer reads in the loop.
void SortWeightsByView(RingBlock& block) {
  block.offsets.assign(block.views + 1, 0);
  for (size_t e = 0; e < block.view.size(); ++e) {
    if (block.weight[e] != 0) ++block.offsets[block.view[e] + 1];
  }
  for (int v = 0; v < block.views; ++v) block.offsets[v + 1] += block.offsets[v];
  block.direction_by_view.resize(block.offsets.back());
  block.weight_by_view.resize(block.offsets.back());
  std::vector<int> next(block.offsets.begin(), block.offsets.end() - 1);
  for (size_t e = 0; e < block.view.size(); ++e) {
    if (block.weight[e] == 0) continue;
    const int place = next[block.view[e]]++;
    block.direction_by_view[place] = static_cast<uint16_t>(e / 3);
    block.weight_by_view[place] = block.weight[e];
  }
}

void FillCentred(const TrianglePatch& patch, const PatchMean& mean, RingBlock& block) {
  block.centred.resize(patch.values.size());
  constexpr float kUnit = 1.f / LightField::kOne;
  size_t at = 0;
  for (int s = 0; s < block.samples; ++s) {
    for (int c = 0; c < kChannels; ++c) {
      const float centre = mean[static_cast<size_t>(s) * kChannels + c];
      for (int v = 0; v < block.views; ++v, ++at) {
        block.centred[at] = block.hat[s] * (static_cast<float>(patch.values[at]) * kUnit - centre);
      }
    }
  }
}

void SetChange(std::vector<float> change, RingBlock& block) {
  block.change = std::move(change);
  const int n = block.edge_samples;
  block.shares.resize(size_t{3} * block.samples);
  for (int j = 0; j < n; ++j) {
    for (int i = 0; i + j < n; ++i) {
      const int sample = PatchSampleIndex(n, i, j);
      const Eigen::Vector3d weights = PatchSampleWeights(n, i, j);
      for (int at = 0; at < 3; ++at) {
        block.shares[3 * sample + at] = block.hat[sample] * static_cast<float>(weights[at]);
      }
    }
  }
}

RingBlock BuildBlock(const LightFieldSource& source, int triangle, int corner,
                     const PatchMean& mean, LightField::WeightBuffer& buffer) {
  const TrianglePatch patch = source.patch(triangle);
  RingBlock block;
  block.triangle = triangle;
  block.corner = corner;
  block.edge_samples = patch.edge_samples;
  block.samples = PatchSampleCount(patch.edge_samples);
  block.views = static_cast<int>(patch.photos.size());
  if (mean.size() != static_cast<size_t>(block.samples) * kChannels) {
    throw Error("encode: the mean view of a triangle does not fit its patch", ErrorKind::kSystem);
  }
  block.hat.resize(block.samples);
  const int n = block.edge_samples;
  for (int j = 0; j < n; ++j) {
    for (int i = 0; i + j < n; ++i) {
      block.hat[PatchSampleIndex(n, i, j)] =
          static_cast<float>(PatchSampleWeights(n, i, j)[corner]);
    }
  }
  if (block.views == 0) return block;
  const ViewWeights weights = source.weights(triangle, corner, buffer);
  block.view.assign(weights.view.begin(), weights.view.end());
  block.weight.assign(weights.weight.begin(), weights.weight.end());
  block.seen.assign(weights.seen.begin(), weights.seen.end());
  if (source.change) SetChange(source.change(triangle, corner, weights), block);
  SortWeightsByView(block);
  FillCentred(patch, mean, block);
  return block;
}

kernels::WeightsByView ByView(const RingBlock& block) {
  return {block.offsets.data(), block.direction_by_view.data(), block.weight_by_view.data()};
}

// C = centred^T centred summed over channels: views x views, in panels of 16 columns.
std::vector<double> ViewGram(const RingBlock& block) {
  const int rows = block.samples * kChannels, views = block.views;
  std::vector<double> gram(static_cast<size_t>(views) * views);
  std::vector<float> panel(static_cast<size_t>(rows) * kPanel);
  std::vector<float> product(static_cast<size_t>(views) * kPanel);
  for (int first = 0; first < views; first += kPanel) {
    const int count = std::min(kPanel, views - first);
    for (int r = 0; r < rows; ++r) {
      for (int c = 0; c < kPanel; ++c) {
        panel[r * kPanel + c] =
            c < count ? block.centred[static_cast<size_t>(r) * views + first + c] : 0;
      }
    }
    kernels::MultiplyTransposed(block.centred.data(), rows, views, panel.data(), kPanel,
                                product.data());
    for (int v = 0; v < views; ++v) {
      for (int c = 0; c < count; ++c) gram[v * views + first + c] = product[v * kPanel + c];
    }
  }
  return gram;
}

// y += shares (change x).
void AddChange(const RingBlock& block, int cols, const float* x, int width, float* y) {
  if (block.change.empty()) return;
  std::vector<float> shown(size_t{3} * width), sum(static_cast<size_t>(block.samples) * width);
  kernels::Multiply(block.change.data(), 3, cols, x, width, shown.data());
  kernels::Multiply(block.shares.data(), block.samples, 3, shown.data(), width, sum.data());
  for (size_t i = 0; i < sum.size(); ++i) y[i] += sum[i];
}

// x += change^T (shares^T y).
void AddChangeTransposed(const RingBlock& block, int cols, const float* y, int width, float* x) {
  if (block.change.empty()) return;
  std::vector<float> shown(size_t{3} * width), sum(static_cast<size_t>(cols) * width);
  kernels::MultiplyTransposed(block.shares.data(), block.samples, 3, y, width, shown.data());
  kernels::MultiplyTransposed(block.change.data(), 3, cols, shown.data(), width, sum.data());
  for (size_t i = 0; i < sum.size(); ++i) x[i] += sum[i];
}

// shares^T centred, 3 rows of 3 x views (channels outer), and shares^T shares.
struct ShareProducts {
  std::vector<double> centred;
  Eigen::Matrix3d squares = Eigen::Matrix3d::Zero();
};

ShareProducts MultiplyShares(const RingBlock& block) {
  const int columns = kChannels * block.views;
  ShareProducts products;
  products.centred.assign(size_t{3} * columns, 0.0);
  for (int s = 0; s < block.samples; ++s) {
    const float* row = block.centred.data() + static_cast<size_t>(s) * columns;
    const Eigen::Vector3d share = Eigen::Vector3f(block.shares.data() + 3 * s).cast<double>();
    products.squares += share * share.transpose();
    for (int at = 0; at < 3; ++at) {
      double* sums = products.centred.data() + static_cast<size_t>(at) * columns;
      for (int i = 0; i < columns; ++i) sums[i] += share[at] * row[i];
    }
  }
  return products;
}

// What the change brings to the squared norm of column q, all channels.
double ChangeEnergy(const RingBlock& block, const ShareProducts& products, size_t q) {
  const size_t directions = block.seen.size();
  double sum = 0;
  for (int c = 0; c < kChannels; ++c) {
    Eigen::Vector3d change, blended = Eigen::Vector3d::Zero();
    for (int at = 0; at < 3; ++at) {
      change[at] = block.change[(3 * at + c) * directions + q];
      const double* centred =
          products.centred.data() + static_cast<size_t>(kChannels * at + c) * block.views;
      for (size_t e = 3 * q; e < 3 * q + 3; ++e) {
        blended[at] += block.weight[e] * centred[block.view[e]];
      }
    }
    sum += change.dot(2 * blended + products.squares * change);
  }
  return sum;
}

}  // namespace

VertexOperator BuildVertexOperator(const LightFieldSource& source, int vertex,
                                   std::span<const int> triangles,
                                   const std::function<PatchMean(int triangle)>& mean) {
  VertexOperator f;
  f.directions = source.grid * source.grid;
  LightField::WeightBuffer buffer;
  float max_abs = 0, max_change = 0;
  for (const int triangle : triangles) {
    const int corner = CornerOf(source.mesh.triangles[triangle], vertex);
    f.blocks.push_back(BuildBlock(source, triangle, corner, mean(triangle), buffer));
    f.blocks.back().first_row = f.rows;
    f.rows += f.blocks.back().samples;
    for (const float value : f.blocks.back().centred) max_abs = std::max(max_abs, std::abs(value));
    for (const float value : f.blocks.back().change) {
      max_change = std::max(max_change, std::abs(value));
    }
  }
  f.max_abs = max_abs + max_change;
  return f;
}

void Multiply(const VertexOperator& f, const float* x, int width, float* y) {
  std::vector<float> by_view;
  for (const RingBlock& block : f.blocks) {
    float* y_block = y + static_cast<size_t>(block.first_row) * width;
    if (block.views == 0) {
      std::fill_n(y_block, static_cast<size_t>(block.samples) * width, 0.f);
      continue;
    }
    by_view.resize(static_cast<size_t>(kChannels) * block.views * width);
    kernels::DirectionsToViews(ByView(block), block.views, f.directions, kChannels, x, width,
                               by_view.data());
    kernels::Multiply(block.centred.data(), block.samples, kChannels * block.views, by_view.data(),
                      width, y_block);
    AddChange(block, f.cols(), x, width, y_block);
  }
}

void MultiplyTransposed(const VertexOperator& f, const float* y, int width, float* x) {
  std::fill_n(x, static_cast<size_t>(f.cols()) * width, 0.f);
  std::vector<float> by_view;
  for (const RingBlock& block : f.blocks) {
    if (block.views == 0) continue;
    by_view.resize(static_cast<size_t>(kChannels) * block.views * width);
    kernels::MultiplyTransposed(block.centred.data(), block.samples, kChannels * block.views,
                                y + static_cast<size_t>(block.first_row) * width, width,
                                by_view.data());
    kernels::AddViewsToDirections(block.view.data(), block.weight.data(), block.views, f.directions,
                                  kChannels, by_view.data(), width, x);
    AddChangeTransposed(block, f.cols(), y + static_cast<size_t>(block.first_row) * width, width,
                        x);
  }
}

LinearMap ScaledMap(const VertexOperator& f, const std::vector<float>& column_scale) {
  const auto scale = [&column_scale, &f](float* x, int width) {
    for (int row = 0; row < f.cols(); ++row) {
      const float factor = column_scale[row % f.directions];
      for (int c = 0; c < width; ++c) x[static_cast<size_t>(row) * width + c] *= factor;
    }
  };
  LinearMap map;
  map.rows = f.rows;
  map.cols = f.cols();
  map.max_abs = f.max_abs;
  map.multiply = [&f, scale](const float* x, int width, float* y) {
    std::vector<float> scaled(x, x + static_cast<size_t>(f.cols()) * width);
    scale(scaled.data(), width);
    Multiply(f, scaled.data(), width, y);
  };
  map.multiply_transposed = [&f, scale](const float* y, int width, float* x) {
    MultiplyTransposed(f, y, width, x);
    scale(x, width);
  };
  return map;
}

Energies ComputeEnergies(const VertexOperator& f, const std::vector<float>& column_scale) {
  Energies energies;
  for (const RingBlock& block : f.blocks) {
    const std::vector<double> gram = ViewGram(block);
    const bool changes = !block.change.empty();
    const ShareProducts products = changes ? MultiplyShares(block) : ShareProducts{};
    for (size_t e = 0; e < block.view.size(); e += 3) {
      double sum = 0;
      for (int a = 0; a < 3; ++a) {
        for (int b = 0; b < 3; ++b) {
          sum += static_cast<double>(block.weight[e + a]) * block.weight[e + b] *
                 gram[static_cast<size_t>(block.view[e + a]) * block.views + block.view[e + b]];
        }
      }
      if (changes) sum += ChangeEnergy(block, products, e / 3);
      const double scale = column_scale[e / 3];
      energies.plain += sum;
      energies.scaled += scale * scale * sum;
    }
  }
  return energies;
}

}  // namespace lfm
