// SPDX-License-Identifier: BSD-3-Clause
#include "fields/relighting.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "core/error.h"
#include "core/parallel.h"
#include "fields/relightable_file.h"
#include "tests/fields/random_relightable.h"

namespace lfm {
namespace {

LightVector RandomLight(int directions, int channels, uint32_t seed) {
  std::mt19937 random(seed);
  LightVector light = MakeLightVector(directions, channels);
  for (float& v : light.values) v = static_cast<float>(random() % 4096) / 1024 - 1;
  return light;
}

struct Truth {
  std::vector<double> value;      // points x channels
  std::vector<double> magnitude;  // the sum of the summands' magnitudes: what rounding goes by
};

// The dense product R I in float64, R written out.
Truth DenseTruth(const RelightableModel& r, const LightVector& light, int residuals) {
  Truth truth;
  truth.value.resize(static_cast<size_t>(r.model.rows));
  truth.magnitude.resize(truth.value.size());
  for (int64_t row = 0; row < r.model.rows; ++row) {
    std::vector<double> function(r.model.columns), magnitude(r.model.columns);
    const FunctionRows& basis = r.model.bases[r.model.cluster[row]];
    for (int64_t t = 0; t < basis.rows; ++t) {
      const double weight = r.model.weights[r.model.first_weight[row] + t];
      for (int i = 0; i < r.model.columns; ++i) {
        function[i] += weight * basis.Row(t)[i];
        magnitude[i] += std::abs(weight * basis.Row(t)[i]);
      }
    }
    if (!r.model.first_residual.empty()) {
      int64_t end = r.model.first_residual[row + 1];
      if (residuals >= 0) end = std::min(end, r.model.first_residual[row] + residuals);
      for (int64_t i = r.model.first_residual[row]; i < end; ++i) {
        function[r.model.residual_column[i]] += r.model.residual_value[i];
        magnitude[r.model.residual_column[i]] += std::abs(r.model.residual_value[i]);
      }
    }
    const int channel = static_cast<int>(row / r.points);
    const size_t at = static_cast<size_t>(row % r.points) * r.channels + channel;
    const float* values = light.Channel(channel);
    const std::vector<float> columns =
        ApplyColumnBasis(r.column_basis, std::vector<float>(values, values + light.directions));
    for (int i = 0; i < r.model.columns; ++i) {
      truth.value[at] += function[i] * columns[i];
      truth.magnitude[at] += magnitude[i] * std::abs(columns[i]);
    }
  }
  return truth;
}

constexpr double kRoundingRel = 2e-6;

void ExpectDense(const RelightableModel& r, const LightVector& light, int residuals) {
  const Relighter relighter(r);
  const PreparedLight prepared = relighter.Prepare(light);
  const Truth truth = DenseTruth(r, light, residuals);
  for (const kernels::RelightLevel level : kernels::kRelightLevels) {
    if (!kernels::Runs(level)) continue;
    const std::vector<float> out = relighter.Relight(prepared, residuals, level);
    ASSERT_EQ(out.size(), truth.value.size());
    for (size_t i = 0; i < out.size(); ++i) {
      ASSERT_NEAR(out[i], truth.value[i], kRoundingRel * truth.magnitude[i])
          << i << " at " << kernels::NameOf(level);
    }
  }
}

TEST(Relighting, IsTheDenseProduct) {
  for (const int channels : {1, 3}) {
    for (const int columns : {1, 20, 253, 256, 257, 700}) {
      const RelightableModel r = RandomRelightable({.width = 37,
                                                    .height = 23,
                                                    .channels = channels,
                                                    .columns = columns,
                                                    .clusters = 11,
                                                    .most_terms = 5,
                                                    .most_residuals = 13});
      for (const int residuals : {-1, 0, 1, 4, 13, 1000}) {
        ExpectDense(r, RandomLight(columns, channels, 7), residuals);
      }
    }
  }
}

TEST(Relighting, TakesManyClustersAndChunks) {
  ExpectDense(RandomRelightable({.width = 101,
                                 .height = 67,
                                 .columns = 40,
                                 .clusters = 700,
                                 .most_terms = 6,
                                 .most_residuals = 3}),
              RandomLight(40, 3, 2), -1);
}

TEST(Relighting, TakesAnyScale) {
  for (const float scale : {1e-25f, 1e-6f, 1e6f, 1e25f}) {
    RelightableModel r = RandomRelightable({});
    for (float& w : r.model.weights) w *= scale;
    for (float& v : r.model.residual_value) v *= scale;
    ExpectDense(AsStored(r), RandomLight(20, 3, 3), -1);
  }
}

TEST(Relighting, TakesExtremes) {
  const RelightableModel one = RandomRelightable(
      {.width = 1, .height = 1, .channels = 1, .columns = 1, .clusters = 1, .most_residuals = 0});
  EXPECT_EQ(Relighter(one).Relight(Relighter(one).Prepare(RandomLight(1, 1, 1)), -1),
            std::vector<float>{0});
  RelightableModel bare = RandomRelightable({});
  bare.model.first_residual.clear();
  bare.model.residual_column.clear();
  bare.model.residual_value.clear();
  ExpectDense(bare, RandomLight(20, 3, 3), -1);
  EXPECT_EQ(Relighter(bare).MostResiduals(), 0);
  ExpectDense(RandomRelightable({.clusters = 1}), RandomLight(20, 3, 3), -1);  // residual alone
}

TEST(Relighting, GoesThroughAColumnBasis) {
  RelightableModel r = RandomRelightable({.columns = 4});
  // Haar over four lights.
  const float h = std::sqrt(0.5f);
  r.column_basis.first = {0, 4, 8, 10, 12};
  r.column_basis.direction = {0, 1, 2, 3, 0, 1, 2, 3, 0, 1, 2, 3};
  r.column_basis.value = {0.5f, 0.5f, 0.5f, 0.5f, 0.5f, 0.5f, -0.5f, -0.5f, h, -h, h, -h};
  ExpectDense(r, RandomLight(4, 3, 5), -1);
  ExpectDense(r, RandomLight(4, 3, 5), 1);
}

TEST(Relighting, ErrorFallsWithEveryResidualInTheMean) {
  // The first n residuals are the largest, so over lights that are independent and of zero mean the
  // expected squared error is what is left of the residual, which falls with n.
  const RelightableModel r =
      RandomRelightable({.width = 24, .height = 20, .columns = 30, .most_residuals = 12});
  const Relighter relighter(r);
  std::vector<double> squares(13);
  for (uint32_t seed = 0; seed < 40; ++seed) {
    LightVector light = RandomLight(30, 3, seed);
    for (float& v : light.values) v -= 1;
    const PreparedLight prepared = relighter.Prepare(light);
    const std::vector<float> all = relighter.Relight(prepared, -1);
    for (int n = 0; n <= 12; ++n) {
      const std::vector<float> out = relighter.Relight(prepared, n);
      for (size_t i = 0; i < out.size(); ++i) squares[n] += std::pow(double{out[i]} - all[i], 2);
    }
  }
  for (int n = 1; n <= 12; ++n) EXPECT_LT(squares[n], squares[n - 1]) << n;
  EXPECT_EQ(squares[12], 0);
}

TEST(Relighting, DoesNotDependOnThreads) {
  const RelightableModel r = RandomRelightable({.width = 80, .height = 90});
  const Relighter relighter(r);
  const LightVector light = RandomLight(20, 3, 9);
  SetThreadCount(1);
  const std::vector<float> one = relighter.Relight(relighter.Prepare(light), -1);
  SetThreadCount(4);
  EXPECT_EQ(one, relighter.Relight(relighter.Prepare(light), -1));
  SetThreadCount(0);
}

TEST(Relighting, MakesPicturesWithPointsRowByRow) {
  const RelightableModel r = RandomRelightable({.width = 5, .height = 3});
  const Relighter relighter(r);
  const PreparedLight prepared = relighter.Prepare(RandomLight(20, 3, 9));
  const Image image = relighter.RelightPicture(prepared, 2);
  const std::vector<float> values = relighter.Relight(prepared, 2);
  EXPECT_EQ(image.width(), 5);
  EXPECT_EQ(image.height(), 3);
  EXPECT_EQ(image.encoding(), ColorEncoding::kLinear);
  EXPECT_EQ(image.At<float>(4, 1, 2), values[(1 * 5 + 4) * 3 + 2]);
  RelightableModel vertices = r;
  vertices.width = vertices.height = 0;
  EXPECT_THROW(Relighter(vertices).RelightPicture(prepared, 2), Error);
}

TEST(Relighting, RefusesLightOfAnotherModel) {
  const Relighter relighter(RandomRelightable({}));
  EXPECT_THROW(relighter.Prepare(RandomLight(19, 3, 1)), Error);
  EXPECT_THROW(relighter.Prepare(RandomLight(20, 1, 1)), Error);
  LightVector light = RandomLight(20, 3, 1);
  light.values[30] = std::numeric_limits<float>::quiet_NaN();
  EXPECT_THROW(relighter.Prepare(light), Error);
  light.values.pop_back();
  EXPECT_THROW(relighter.Prepare(light), Error);
  EXPECT_THROW(relighter.Relight({}, 0), Error);
  RelightableModel views = RandomRelightable({});
  views.kind = FieldColumns::kViews;
  EXPECT_THROW(Relighter{views}, Error);
}

}  // namespace
}  // namespace lfm
