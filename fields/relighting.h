// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/image.h"
#include "fields/light_vector.h"
#include "fields/relight_kernels.h"
#include "fields/relightable_model.h"

namespace lfm {

/// What depends on the light alone, by channel.
struct PreparedLight {
  struct Channel {
    std::vector<float> products;  ///< terms x clusters: F^k_t I, with all scales
    std::vector<float> light;     ///< a column of the residual: its light, with their scale
  };
  std::vector<Channel> channels;
};

/// Relights a clustered model (Yamada 2009, Section 4, Equation 15):
///
///   R_p = sum_t W_pt (F_t^c(p) I) + E_p I
///
/// The products in brackets are made once a light, for the clusters that a channel uses; then every
/// row takes its few weights and as many of its residuals as asked for, largest first. Holds the
/// model once more as float16 in groups of 16 rows. Usable from many threads; a call uses those
/// that SetThreadCount allows, and its result does not depend on them.
class Relighter {
 public:
  /// Throws Error when CheckRelightable does, or when columns are directions towards the eye. Keeps
  /// nothing of the model.
  explicit Relighter(const RelightableModel& relightable);

  int64_t points() const { return points_; }
  int channels() const { return static_cast<int>(rows_.size()); }
  int directions() const { return directions_; }
  /// The most residuals that a row has.
  int MostResiduals() const { return most_residuals_; }
  int64_t MemoryBytes() const;

  /// Throws Error when directions or channels are not the model's, or a number is not finite.
  PreparedLight Prepare(const LightVector& light) const;
  /// Linear radiance, points x channels, with the first `residuals` residuals of each row
  /// (negative: all). Sums in float32. `level` must be one that runs here.
  std::vector<float> Relight(const PreparedLight& light, int residuals,
                             kernels::RelightLevel level = kernels::BestRelightLevel()) const;
  /// The same as a linear float picture; of vertices, an Error.
  Image RelightPicture(const PreparedLight& light, int residuals) const;

 private:
  // Of one channel, residuals of the ranks from kTierRanks * tier on, kTierRanks of them, as
  // kernels::GroupResiduals: what few residuals need lies together.
  struct Tier {
    std::vector<int64_t> first = {0};
    std::vector<uint16_t> values, wide_columns;
    std::vector<uint8_t> narrow_columns;
  };
  // One channel, as kernels::GroupWeights and the tiers of its residuals.
  struct Rows {
    std::vector<int> used;  // clusters, ascending; rows hold indices into these
    std::vector<uint16_t> cluster, weights;
    std::vector<int64_t> first_weight = {0};
    std::vector<Tier> tiers;
  };
  struct Exponents {
    int weight = 0, residual = 0;
  };
  Rows MakeRows(const ClusteredModel& model, int channel) const;
  void AddWeights(const ClusteredModel& model, const std::vector<int64_t>& group, Rows& rows) const;
  void AddTier(const ClusteredModel& model, const std::vector<int64_t>& group, int64_t first_rank,
               Tier& tier) const;
  void RelightGroups(const Rows& rows, const PreparedLight::Channel& light, int64_t first,
                     int64_t count, int residuals, kernels::RelightLevel level, float* sums) const;
  void Fill(const PreparedLight& light, int residuals, kernels::RelightLevel level,
            float* out) const;

  int64_t points_ = 0;
  int width_ = 0, height_ = 0, directions_ = 0, columns_ = 0, stride_ = 0;
  int most_residuals_ = 0, most_terms_ = 0;
  ColumnBasis column_basis_;
  Exponents exponents_;
  std::vector<int64_t> first_function_;  // a cluster, and the end
  std::vector<uint16_t> functions_;      // float16, a function every stride_
  std::vector<int> function_exponents_;
  std::vector<Rows> rows_;  // a channel
};

}  // namespace lfm
