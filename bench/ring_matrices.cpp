// SPDX-License-Identifier: BSD-3-Clause
#include "ring_matrices.h"

#include <algorithm>
#include <utility>

#include "core/triangle_mesh.h"
#include "resample/resample.h"
#include "resample/view_weights.h"

namespace lfm::bench {
namespace {

using Eigen::Index;

constexpr int kEveryPhoto = 3;

std::vector<Eigen::Vector2d> InPlane(std::span<const Eigen::Vector3d> directions) {
  std::vector<Eigen::Vector2d> plane;
  for (const Eigen::Vector3d& d : directions) plane.push_back(PlaneFromDirection(kMap, d));
  return plane;
}

}  // namespace

Ring RingOf(const Object& object, int vertex, std::span<const int> triangles) {
  const auto v = static_cast<size_t>(vertex);
  const TriangleMesh& mesh = object.field.mesh();
  const Eigen::Matrix3d world_to_frame = object.field.vertex_frames()[v].transpose();
  Ring ring;
  for (const int triangle : triangles) {
    RingPatch patch{ViewsOf(object, triangle), ring.rows, {}, {}, {}, {}, {}};
    const size_t count = patch.views.to_eye.size();
    if (count < kLeastViews) continue;
    const Eigen::Vector3i& corners = mesh.triangles[static_cast<size_t>(triangle)];
    const int corner = corners[0] == vertex ? 0 : corners[1] == vertex ? 1 : 2;
    const int n = patch.views.patch.edge_samples;
    for (int j = 0; j < n; ++j) {
      for (int i = 0; i + j < n; ++i) {
        const double hat = PatchSampleWeights(n, i, j)[corner];
        if (!(hat > 0)) continue;
        patch.hats.push_back(hat);
        patch.samples.push_back(static_cast<size_t>(PatchSampleIndex(n, i, j)));
      }
    }
    for (size_t view = 0; view < count; ++view) {
      const uint16_t photo = patch.views.patch.photos[view];
      patch.in_frame.push_back(world_to_frame * patch.views.to_eye[view]);
      const bool is_left_out = (photo + vertex) % kEveryPhoto == 0;
      (is_left_out ? patch.left_out : patch.kept).push_back(view);
      if (!is_left_out) ring.photos.push_back(photo);
    }
    ring.rows += static_cast<Index>(patch.hats.size());
    ring.patches.push_back(std::move(patch));
  }
  std::sort(ring.photos.begin(), ring.photos.end());
  ring.photos.erase(std::unique(ring.photos.begin(), ring.photos.end()), ring.photos.end());
  for (const uint16_t photo : ring.photos) {
    ring.in_frame.push_back(world_to_frame *
                            (object.centers[photo] - mesh.vertices[v]).normalized());
  }
  return ring;
}

Matrix Blends(std::span<const Eigen::Vector3d> sites, std::span<const size_t> from,
              std::span<const Eigen::Vector2d> queries) {
  Matrix blends =
      Matrix::Zero(static_cast<Index>(sites.size()), static_cast<Index>(queries.size()));
  const auto mixes = MixesOf(InPlane(sites), from, queries, ResampleOptions{}.hull_margin);
  for (size_t q = 0; q < mixes.size(); ++q) {
    for (size_t k = 0; k < 3; ++k) {
      blends(static_cast<Index>(mixes[q].view[k]), static_cast<Index>(q)) += mixes[q].weight[k];
    }
  }
  return blends;
}

Eigen::VectorXd GridTaps(int grid, const Eigen::Vector3d& direction) {
  const Eigen::Vector2d place = SquareFromDirection(kMap, direction) * (grid - 1);
  const int x = std::min(static_cast<int>(place.x()), grid - 2);
  const int y = std::min(static_cast<int>(place.y()), grid - 2);
  const double fx = place.x() - x, fy = place.y() - y;
  Eigen::VectorXd taps = Eigen::VectorXd::Zero(grid * grid);
  taps[y * grid + x] = (1 - fx) * (1 - fy);
  taps[y * grid + x + 1] = fx * (1 - fy);
  taps[(y + 1) * grid + x] = (1 - fx) * fy;
  taps[(y + 1) * grid + x + 1] = fx * fy;
  return taps;
}

Matrix PatchMatrix(const RingPatch& patch) {
  const auto views = static_cast<Index>(patch.in_frame.size());
  Matrix values(static_cast<Index>(patch.hats.size()), kChannels * views);
  for (Index r = 0; r < values.rows(); ++r) {
    const auto at = static_cast<size_t>(r);
    for (Index c = 0; c < values.cols(); ++c) {
      values(r, c) =
          patch.hats[at] * patch.views.At(3 * patch.samples[at] + static_cast<size_t>(c / views),
                                          static_cast<size_t>(c % views));
    }
  }
  return values;
}

Centred Centre(Matrix values) {
  Centred centred{std::move(values), Matrix(0, 0)};
  centred.mean.resize(centred.values.rows(), kChannels);
  const Index columns = centred.values.cols() / kChannels;
  for (int c = 0; c < kChannels; ++c) {
    centred.mean.col(c) = Channel(centred.values, c).rowwise().mean();
    centred.values.middleCols(c * columns, columns).colwise() -= centred.mean.col(c);
  }
  return centred;
}

Matrix ResampledMatrix(const Ring& ring, int grid) {
  const std::vector<Eigen::Vector2d> queries = GridInPlane(kMap, grid);
  Matrix all(ring.rows, kChannels * grid * grid);
  for (const RingPatch& patch : ring.patches) {
    const Matrix values = PatchMatrix(patch), blends = Blends(patch.in_frame, patch.kept, queries);
    for (int c = 0; c < kChannels; ++c) {
      all.block(patch.first_row, c * blends.cols(), values.rows(), blends.cols()) =
          Channel(values, c) * blends;
    }
  }
  return all;
}

PhotoMatrix PhotographsOf(const Ring& ring) {
  const auto photos = static_cast<Index>(ring.photos.size());
  PhotoMatrix matrix{Matrix::Zero(ring.rows, kChannels * photos), Matrix(ring.rows, kChannels),
                     Matrix::Zero(ring.rows, kChannels * photos)};
  for (const RingPatch& patch : ring.patches) {
    const Matrix values = PatchMatrix(patch);
    const auto views = static_cast<Index>(patch.in_frame.size());
    for (int c = 0; c < kChannels; ++c) {
      Eigen::VectorXd mean = Eigen::VectorXd::Zero(values.rows());
      for (const size_t v : patch.kept) {
        mean +=
            values.col(c * views + static_cast<Index>(v)) / static_cast<double>(patch.kept.size());
      }
      matrix.mean.block(patch.first_row, c, values.rows(), 1) = mean;
      for (const size_t v : patch.kept) {
        const auto place =
            std::lower_bound(ring.photos.begin(), ring.photos.end(), patch.views.patch.photos[v]);
        const Index column = c * photos + (place - ring.photos.begin());
        matrix.values.block(patch.first_row, column, values.rows(), 1) =
            values.col(c * views + static_cast<Index>(v)) - mean;
        matrix.known.block(patch.first_row, column, values.rows(), 1).setOnes();
      }
    }
  }
  return matrix;
}

}  // namespace lfm::bench
