// SPDX-License-Identifier: BSD-3-Clause
// Whether to factorise photographs before views are resampled, or after:
// lfm-bench-photographs-first WORK [EVERY].
//
// Chen 2002 (section 5.2) resamples views first and says that this approximates more precisely;
// Nishino's eigen-textures factorise the photographs. Every EVERY-th vertex ring of an object (40)
// is taken apart both ways, with monochrome surface maps and RGB view maps, in float64 and without
// quantisation:
//
//   resampled first:     rows of samples x (channel, grid direction), each triangle's views blended
//                        onto the grid, then the best K terms (what we do)
//   photographs first:   rows of samples x (channel, photograph), with gaps where a photograph does
//                        not show a triangle: K terms by alternating least squares with a small
//                        ridge; their coefficients are then blended onto the grid
//   ... views refitted:  the surface maps of these, and the view maps that fit the resampled matrix
//                        best beside them
//   resampled first, with a coarser grid, for the bytes of the next
//   ... without a grid:  coefficients kept a photograph, and blended when a direction is asked for
//
// Judged against the resampled matrix, and against photographs (every third, left out of all of
// it) at the directions that they were taken from. Prints a Markdown table.
#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <numeric>
#include <vector>

#include "core/error.h"
#include "core/parallel.h"
#include "core/triangle_mesh.h"
#include "resample/view_weights.h"
#include "ring_matrices.h"

namespace lfm::bench {
namespace {

using Eigen::Index;

constexpr std::array kTerms = {1, 2, 3, 4, 6, 8};
constexpr double kRangeBytes = 16;  // scale and bias of both maps

/// Eigenvectors of a symmetric matrix, the largest eigenvalue first.
Matrix Leading(const Matrix& gram, int terms) {
  const Eigen::SelfAdjointEigenSolver<Matrix> solver(gram);
  return solver.eigenvectors().rightCols(std::min<Index>(terms, gram.rows())).rowwise().reverse();
}

/// Each column of `solved` (K x columns): the ridge regression of a column of `values` on `basis`
/// (rows x K), where it is known.
Matrix Regress(const Matrix& basis, const Matrix& values, const Matrix& known, double ridge) {
  Matrix solved(basis.cols(), values.cols());
  for (Index c = 0; c < values.cols(); ++c) {
    const Matrix weighted = known.col(c).asDiagonal() * basis;
    Matrix gram = weighted.transpose() * basis;
    gram.diagonal().array() += ridge;
    solved.col(c) = gram.llt().solve(weighted.transpose() * values.col(c));
  }
  return solved;
}

struct Factors {
  Matrix surface;  ///< rows x K
  Matrix views;    ///< K x columns
};

Factors FactorizePhotographs(const PhotoMatrix& photos, int terms) {
  constexpr int kSweeps = 25;
  constexpr double kRidge_rel = 1e-3;
  Factors factors;
  factors.surface = Leading(photos.values * photos.values.transpose(), terms);
  for (int sweep = 0; sweep < kSweeps; ++sweep) {
    const double rows_known = photos.known.sum() / static_cast<double>(photos.known.size());
    factors.views = Regress(factors.surface, photos.values, photos.known, kRidge_rel * rows_known);
    const double ridge = kRidge_rel * factors.views.squaredNorm() / terms;
    factors.surface = Regress(factors.views.transpose(), photos.values.transpose(),
                              photos.known.transpose(), ridge)
                          .transpose();
    const Eigen::HouseholderQR<Matrix> qr(factors.surface);
    factors.surface =
        qr.householderQ() * Matrix::Identity(factors.surface.rows(), factors.surface.cols());
  }
  factors.views = Regress(factors.surface, photos.values, photos.known, 1e-6);
  return factors;
}

/// K x (channel, column) times blends a channel.
Matrix Blended(const Matrix& views, const Matrix& blends) {
  Matrix result(views.rows(), kChannels * blends.cols());
  for (int c = 0; c < kChannels; ++c) {
    result.middleCols(c * blends.cols(), blends.cols()) = Channel(views, c) * blends;
  }
  return result;
}

constexpr int kGrid = 16, kCoarseGrid = 8;
enum Way { kResampledFirst, kPhotographsFirst, kRefitted, kCoarse, kWithoutGrid, kWayCount };
constexpr std::array<const char*, kWayCount> kNames = {
    "resampled first", "photographs first", "photographs first, views refitted",
    "resampled first, 8×8 directions", "photographs first, without a grid"};

struct Sums {
  std::array<std::array<SquaredError, kTerms.size()>, kWayCount> matrix, photos;
  std::array<double, kWayCount> bytes_a_term = {};
  SquaredError resampled;                    ///< photographs against the resampled matrix itself
  double rings = 0, known = 0, entries = 0;  ///< of the photographs' matrices
};

/// Against the photographs that were left out: `at(patch, view)` gives the ring's rows x channels.
template <typename Predict>
void JudgePhotographs(const Ring& ring, const Predict& at, SquaredError& error) {
  for (const RingPatch& patch : ring.patches) {
    const Matrix values = PatchMatrix(patch);
    const auto views = static_cast<Index>(patch.in_frame.size());
    for (const size_t view : patch.left_out) {
      const Matrix shown = at(patch, view);
      for (int c = 0; c < kChannels; ++c) {
        for (Index r = 0; r < values.rows(); ++r) {
          error.Add(shown(patch.first_row + r, c) -
                    values(r, c * views + static_cast<Index>(view)));
        }
      }
    }
  }
}

/// A model's values at one direction: mean + surface x (views blended by `taps`), a channel.
Matrix Shown(const Matrix& mean, const Matrix& surface, const Matrix& views,
             const Eigen::VectorXd& taps) {
  Matrix shown = mean;
  for (int c = 0; c < kChannels; ++c) shown.col(c) += surface * (Channel(views, c) * taps);
  return shown;
}

/// A ring's model: mean + surface x views, these on a grid of directions.
struct Model {
  const Matrix& mean;
  const Matrix& surface;
  Matrix views;
};

/// Judges the ways for one ring.
class RingJudge {
 public:
  explicit RingJudge(const Ring& ring)
      : ring_(ring),
        resampled_(Centre(ResampledMatrix(ring, kGrid))),
        coarse_(Centre(ResampledMatrix(ring, kCoarseGrid))),
        photos_(PhotographsOf(ring)),
        all_(ring.photos.size()) {
    std::iota(all_.begin(), all_.end(), size_t{0});
  }

  Sums Ask() {
    const Matrix best = Leading(resampled_.values * resampled_.values.transpose(), kTerms.back());
    const Matrix coarse = Leading(coarse_.values * coarse_.values.transpose(), kTerms.back());
    for (size_t k = 0; k < kTerms.size(); ++k) {
      const auto terms = std::min<Index>(kTerms[k], best.cols());
      const Matrix surface = best.leftCols(terms), coarse_surface = coarse.leftCols(terms);
      AskOnGrid(kResampledFirst, k,
                {resampled_.mean, surface, surface.transpose() * resampled_.values});
      const Model small{coarse_.mean, coarse_surface, coarse_surface.transpose() * coarse_.values};
      AskPhotographs(small, kCoarseGrid, sums_.photos[kCoarse][k]);
      AskPhotographsFirst(k, FactorizePhotographs(photos_, static_cast<int>(terms)));
    }
    const Matrix whole = Matrix::Identity(ring_.rows, ring_.rows);
    AskPhotographs({resampled_.mean, whole, resampled_.values}, kGrid, sums_.resampled);
    CountBytes();
    return sums_;
  }

 private:
  void CountBytes() {
    const auto rest = static_cast<double>(ring_.rows) + kRangeBytes;
    sums_.rings = 1;
    sums_.known = photos_.known.sum();
    sums_.entries = static_cast<double>(photos_.known.size());
    sums_.bytes_a_term.fill(rest + kChannels * kGrid * kGrid);
    sums_.bytes_a_term[kCoarse] = rest + kChannels * kCoarseGrid * kCoarseGrid;
    sums_.bytes_a_term[kWithoutGrid] = rest + static_cast<double>(kChannels * all_.size());
  }

  void AskPhotographsFirst(size_t k, const Factors& factors) {
    const Matrix onto_grid = Blends(ring_.in_frame, all_, GridInPlane(kMap, kGrid));
    AskOnGrid(kPhotographsFirst, k,
              {photos_.mean, factors.surface, Blended(factors.views, onto_grid)});
    AskOnGrid(kRefitted, k,
              {resampled_.mean, factors.surface, factors.surface.transpose() * resampled_.values});
    JudgePhotographs(
        ring_,
        [&](const RingPatch& patch, size_t view) {
          const std::array query = {PlaneFromDirection(kMap, patch.in_frame[view])};
          return Shown(photos_.mean, factors.surface, factors.views,
                       Blends(ring_.in_frame, all_, query).col(0));
        },
        sums_.photos[kWithoutGrid][k]);
  }

  void AskOnGrid(Way way, size_t k, const Model& model) {
    for (int c = 0; c < kChannels; ++c) {
      const Matrix difference =
          (Channel(resampled_.values, c) - model.surface * Channel(model.views, c)).colwise() +
          (resampled_.mean.col(c) - model.mean.col(c));
      sums_.matrix[way][k].squares += difference.squaredNorm();
      sums_.matrix[way][k].count += static_cast<double>(difference.size());
    }
    AskPhotographs(model, kGrid, sums_.photos[way][k]);
  }

  void AskPhotographs(const Model& model, int grid, SquaredError& error) const {
    JudgePhotographs(
        ring_,
        [&](const RingPatch& patch, size_t view) {
          return Shown(model.mean, model.surface, model.views,
                       GridTaps(grid, patch.in_frame[view]));
        },
        error);
  }

  const Ring& ring_;
  Centred resampled_, coarse_;
  PhotoMatrix photos_;
  std::vector<size_t> all_;
  Sums sums_;
};

void Print(const std::vector<Sums>& rings) {
  Sums total;
  for (const Sums& s : rings) {
    for (size_t w = 0; w < kWayCount; ++w) {
      for (size_t k = 0; k < kTerms.size(); ++k) {
        total.matrix[w][k].Add(s.matrix[w][k]);
        total.photos[w][k].Add(s.photos[w][k]);
      }
      total.bytes_a_term[w] += s.bytes_a_term[w];
    }
    total.resampled.Add(s.resampled);
    total.rings += s.rings;
    total.known += s.known;
    total.entries += s.entries;
  }
  std::printf(
      "%.0f rings; of their photographs' matrices %.1f %% is known; photographs left out against "
      "the resampled matrix itself %.2f dB\n\n| way | bytes a term | against |",
      total.rings, 100 * total.known / total.entries, total.resampled.PsnrDb());
  for (const int k : kTerms) std::printf(" %d |", k);
  std::printf("\n|---|---|---|---|---|---|---|---|---|\n");
  for (size_t w = 0; w < kWayCount; ++w) {
    for (const auto* errors : {&total.matrix[w], &total.photos[w]}) {
      if ((*errors)[0].count == 0) continue;
      std::printf("| %s | %.0f | %s |", kNames[w], total.bytes_a_term[w] / total.rings,
                  errors == &total.matrix[w] ? "the resampled matrix" : "photographs left out");
      for (const SquaredError& error : *errors) std::printf(" %.2f |", error.PsnrDb());
      std::printf("\n");
    }
  }
}

void Run(const std::filesystem::path& work, int every) {
  const Object object = LoadObject(work);
  const VertexRings rings = ComputeVertexRings(object.field.mesh());
  const int64_t count = static_cast<int64_t>(object.field.mesh().vertices.size()) / every;
  std::vector<Sums> sums(static_cast<size_t>(count));
  ParallelFor(0, count, [&](int64_t i) {
    const auto v = static_cast<size_t>(i * every);
    const Ring ring = RingOf(object, static_cast<int>(v), rings.Ring(v));
    if (ring.rows > 0) sums[static_cast<size_t>(i)] = RingJudge(ring).Ask();
  });
  Print(sums);
}

}  // namespace
}  // namespace lfm::bench

int main(int argc, char** argv) {
  const int every = argc == 3 ? std::atoi(argv[2]) : 40;
  if (argc < 2 || argc > 3 || every < 1) {
    std::fprintf(stderr, "usage: lfm-bench-photographs-first WORK [EVERY]\n");
    return 2;
  }
  try {
    lfm::bench::Run(argv[1], every);
  } catch (const lfm::Error& error) {
    std::fprintf(stderr, "lfm-bench-photographs-first: error: %s\n", error.what());
    return 2;
  }
}
