// SPDX-License-Identifier: BSD-3-Clause
#include "fields/relighting.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "core/error.h"
#include "core/parallel.h"
#include "fields/half_floats.h"

namespace lfm {
namespace {

constexpr int kGroup = kernels::kGroupRows;
constexpr int kTierRanks = 8;
constexpr int64_t kChunkGroups = 128;  // three channels of which stay in the first cache

int64_t ResidualsOf(const ClusteredModel& model, int64_t row) {
  return model.first_residual.empty() ? 0
                                      : model.first_residual[row + 1] - model.first_residual[row];
}

}  // namespace

Relighter::Relighter(const RelightableModel& r) {
  CheckRelightable(r);
  if (r.kind == FieldColumns::kViews) {
    throw Error((r.name.empty() ? "the model" : r.name) +
                " holds a light field of views, which cannot be relit");
  }
  points_ = r.points;
  width_ = r.width;
  height_ = r.height;
  directions_ = static_cast<int>(r.directions.size());
  columns_ = r.model.columns;
  stride_ = (columns_ + kGroup - 1) / kGroup * kGroup;
  column_basis_ = r.column_basis;
  exponents_ = {HalfExponent(r.model.weights), HalfExponent(r.model.residual_value)};
  first_function_.push_back(0);
  for (const FunctionRows& basis : r.model.bases) {
    most_terms_ = std::max(most_terms_, static_cast<int>(basis.rows));
    for (int64_t t = 0; t < basis.rows; ++t) {
      const HalfFloats half = ToHalf({basis.Row(t), static_cast<size_t>(columns_)});
      function_exponents_.push_back(half.exponent);
      functions_.insert(functions_.end(), half.bits.begin(), half.bits.end());
      functions_.resize(function_exponents_.size() * static_cast<size_t>(stride_));
    }
    first_function_.push_back(static_cast<int64_t>(function_exponents_.size()));
  }
  for (int64_t row = 0; row < r.model.rows; ++row) {
    most_residuals_ = std::max(most_residuals_, static_cast<int>(ResidualsOf(r.model, row)));
  }
  rows_.resize(static_cast<size_t>(r.channels));
  ParallelFor(0, r.channels, [&](int64_t c) { rows_[c] = MakeRows(r.model, static_cast<int>(c)); });
}

Relighter::Rows Relighter::MakeRows(const ClusteredModel& model, int channel) const {
  Rows rows;
  const int64_t first = channel * points_;
  std::vector<int> index(model.bases.size(), -1);
  for (int64_t p = 0; p < points_; ++p) index[model.cluster[first + p]] = 0;
  for (size_t k = 0; k < index.size(); ++k) {
    if (index[k] < 0) continue;
    index[k] = static_cast<int>(rows.used.size());
    rows.used.push_back(static_cast<int>(k));
  }
  rows.tiers.resize(static_cast<size_t>((most_residuals_ + kTierRanks - 1) / kTierRanks));
  std::vector<int64_t> group;
  for (int64_t p = 0; p < points_; p += kGroup) {
    group.clear();
    for (int64_t i = p; i < std::min(p + kGroup, points_); ++i) group.push_back(first + i);
    for (const int64_t row : group) {
      rows.cluster.push_back(static_cast<uint16_t>(index[model.cluster[row]]));
    }
    rows.cluster.resize(rows.cluster.size() + kGroup - group.size());
    AddWeights(model, group, rows);
    for (size_t i = 0; i < rows.tiers.size(); ++i) {
      AddTier(model, group, static_cast<int64_t>(i) * kTierRanks, rows.tiers[i]);
    }
  }
  return rows;
}

void Relighter::AddWeights(const ClusteredModel& model, const std::vector<int64_t>& group,
                           Rows& rows) const {
  int64_t terms = 0;
  for (const int64_t row : group) terms = std::max<int64_t>(terms, model.Terms(row));
  for (int64_t t = 0; t < terms; ++t) {
    for (size_t i = 0; i < kGroup; ++i) {
      const bool there = i < group.size() && t < model.Terms(group[i]);
      rows.weights.push_back(
          there ? HalfBits(model.weights[model.first_weight[group[i]] + t], exponents_.weight)
                : uint16_t{0});
    }
  }
  rows.first_weight.push_back(rows.first_weight.back() + terms);
}

void Relighter::AddTier(const ClusteredModel& model, const std::vector<int64_t>& group,
                        int64_t first_rank, Tier& tier) const {
  int64_t end_rank = first_rank;
  for (const int64_t row : group) end_rank = std::max(end_rank, ResidualsOf(model, row));
  end_rank = std::min(end_rank, first_rank + kTierRanks);
  for (int64_t rank = first_rank; rank < end_rank; ++rank) {
    for (size_t i = 0; i < kGroup; ++i) {
      const bool there = i < group.size() && rank < ResidualsOf(model, group[i]);
      const int64_t at = there ? model.first_residual[group[i]] + rank : 0;
      const uint16_t column = there ? model.residual_column[at] : uint16_t{0};
      tier.values.push_back(there ? HalfBits(model.residual_value[at], exponents_.residual)
                                  : uint16_t{0});
      if (columns_ <= 256) {
        tier.narrow_columns.push_back(static_cast<uint8_t>(column));
      } else {
        tier.wide_columns.push_back(column);
      }
    }
  }
  tier.first.push_back(tier.first.back() + end_rank - first_rank);
}

int64_t Relighter::MemoryBytes() const {
  size_t bytes = 2 * functions_.size();
  for (const Rows& rows : rows_) {
    bytes += 2 * (rows.cluster.size() + rows.weights.size()) + 8 * rows.first_weight.size();
    for (const Tier& tier : rows.tiers) {
      bytes += 2 * (tier.values.size() + tier.wide_columns.size()) + tier.narrow_columns.size() +
               8 * tier.first.size();
    }
  }
  return static_cast<int64_t>(bytes);
}

PreparedLight Relighter::Prepare(const LightVector& light) const {
  if (light.directions != directions_ || light.channels != channels() ||
      light.values.size() != static_cast<size_t>(directions_) * light.channels) {
    throw Error("light over " + std::to_string(light.directions) + " directions in " +
                std::to_string(light.channels) + " channels for a model of " +
                std::to_string(directions_) + " and " + std::to_string(channels()));
  }
  for (const float v : light.values) {
    if (!std::isfinite(v)) throw Error("the light is not finite");
  }
  PreparedLight prepared;
  for (int c = 0; c < channels(); ++c) {
    const float* values = light.Channel(c);
    std::vector<float> columns =
        ApplyColumnBasis(column_basis_, std::vector<float>(values, values + directions_));
    columns.resize(static_cast<size_t>(stride_));
    const Rows& rows = rows_[c];
    const auto clusters = static_cast<int64_t>(rows.used.size());
    PreparedLight::Channel channel;
    channel.products.resize(static_cast<size_t>(most_terms_ * clusters));
    ParallelFor(
        0, clusters,
        [&](int64_t k) {
          const int64_t first = first_function_[rows.used[k]];
          const int64_t terms = first_function_[rows.used[k] + 1] - first;
          std::vector<float> products(static_cast<size_t>(terms));
          kernels::HalfProducts(kernels::BestRelightLevel(), functions_.data() + first * stride_,
                                terms, stride_, columns.data(), products.data());
          for (int64_t t = 0; t < terms; ++t) {
            channel.products[t * clusters + k] =
                std::ldexp(products[t], function_exponents_[first + t] + exponents_.weight);
          }
        },
        16);
    for (float& v : columns) v = std::ldexp(v, exponents_.residual);
    channel.light = std::move(columns);
    prepared.channels.push_back(std::move(channel));
  }
  return prepared;
}

void Relighter::RelightGroups(const Rows& rows, const PreparedLight::Channel& light, int64_t first,
                              int64_t count, int residuals, kernels::RelightLevel level,
                              float* sums) const {
  kernels::WeighProducts(
      level, {rows.cluster.data(), rows.first_weight.data(), rows.weights.data()}, first, count,
      light.products.data(), static_cast<int>(rows.used.size()), sums);
  for (const Tier& tier : rows.tiers) {
    if (residuals <= 0) return;
    kernels::AddResiduals(
        level,
        {tier.first.data(), tier.values.data(),
         columns_ <= 256 ? tier.narrow_columns.data() : nullptr, tier.wide_columns.data()},
        first, count, light.light.data(), residuals, sums);
    residuals -= kTierRanks;
  }
}

void Relighter::Fill(const PreparedLight& light, int residuals, kernels::RelightLevel level,
                     float* out) const {
  if (static_cast<int>(light.channels.size()) != channels()) {
    throw Error("light that was prepared for another model");
  }
  if (residuals < 0) residuals = most_residuals_;
  const int64_t groups = (points_ + kGroup - 1) / kGroup;
  const int interleaved = channels();
  ParallelChunks(groups, kChunkGroups, [&](int64_t begin, int64_t end, int64_t) {
    float sums[kChunkGroups * kGroup];
    const int64_t first = begin * kGroup, last = std::min(end * kGroup, points_);
    for (int c = 0; c < interleaved; ++c) {
      RelightGroups(rows_[c], light.channels[c], begin, end - begin, residuals, level, sums);
      for (int64_t p = first; p < last; ++p) out[p * interleaved + c] = sums[p - first];
    }
  });
}

std::vector<float> Relighter::Relight(const PreparedLight& light, int residuals,
                                      kernels::RelightLevel level) const {
  std::vector<float> out(static_cast<size_t>(points_) * rows_.size());
  Fill(light, residuals, level, out.data());
  return out;
}

Image Relighter::RelightPicture(const PreparedLight& light, int residuals) const {
  if (width_ == 0) throw Error("a model of vertices has no picture");
  Image image(width_, height_, channels(), PixelType::kFloat32, ColorEncoding::kLinear);
  Fill(light, residuals, kernels::BestRelightLevel(), image.Data<float>());
  return image;
}

}  // namespace lfm
