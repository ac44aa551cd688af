// SPDX-License-Identifier: BSD-3-Clause
#include "bench/transport_rows.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "core/capture.h"
#include "core/error.h"
#include "core/ply.h"
#include "core/transport_matrix.h"
#include "fields/wavelet_reduction.h"

namespace lfm::bench {
namespace {

constexpr float kOwnTexel = 0.2f;

bool SeesTheScene(const float* row, int64_t columns) {
  float most = 0;
  for (int64_t j = 0; j < columns; ++j) most = std::max(most, row[j]);
  return most > 0 && most < kOwnTexel;
}

void ReadLitRows(const TransportMatrix& matrix, int64_t columns, TransportRows& result) {
  const int64_t points = matrix.shape().points, width = matrix.shape().row_values();
  constexpr int64_t kBlock = 1024;
  result.rows = MakeFunctionRows(points, static_cast<int>(columns));
  int64_t count = 0;
  for (int64_t first = 0; first < points; first += kBlock) {
    const int64_t block = std::min(kBlock, points - first);
    const std::vector<float> values = matrix.ReadRows(first, block);
    for (int64_t i = 0; i < block; ++i) {
      const float* row = values.data() + i * width;
      const bool lit = SeesTheScene(row, columns);
      if (!result.picture.row.empty()) result.picture.row[first + i] = lit ? count : -1;
      if (!lit) continue;
      result.positions[count] = result.positions[first + i];
      std::copy_n(row, columns, result.rows.Row(count++));
    }
  }
  result.rows.rows = count;
  result.rows.values.resize(static_cast<size_t>(count) * result.rows.stride);
  result.positions.resize(static_cast<size_t>(count));
}

}  // namespace

TransportRows ReadTransportRows(const std::filesystem::path& folder) {
  const Capture capture = LoadCapture(folder);
  if (!capture.transport) throw Error(folder.string() + " holds no light transport");
  const TransportMatrix matrix(folder / capture.transport->file);
  TransportRows result;
  result.name = capture.name;
  const int64_t points = matrix.shape().points;
  result.positions.resize(static_cast<size_t>(points));
  if (capture.transport->kind == TransportKind::kImage) {
    const CaptureCamera& camera = capture.cameras.at(capture.transport->camera);
    if (int64_t{camera.width} * camera.height != points) throw Error("not a picture's rows");
    result.picture = {camera.width, camera.height, std::vector<int64_t>(points, -1)};
    for (int64_t i = 0; i < points; ++i) {
      result.positions[i] = {static_cast<float>(i % camera.width),
                             static_cast<float>(i / camera.width), 0};
    }
  } else {
    const TriangleMesh mesh = ReadPlyMesh(folder / capture.transport->mesh);
    for (int64_t i = 0; i < points; ++i) result.positions[i] = mesh.vertices.at(i).cast<float>();
  }
  ReadLitRows(matrix, matrix.shape().columns(), result);
  return result;
}

TransportRows SomeOf(const TransportRows& all, const std::vector<int64_t>& which) {
  TransportRows some;
  some.name = all.name;
  some.rows = GatherRows(all.rows.View(), which);
  std::vector<int64_t> number(static_cast<size_t>(all.rows.rows), -1);
  for (size_t i = 0; i < which.size(); ++i) {
    number[which[i]] = static_cast<int64_t>(i);
    some.positions.push_back(all.positions[which[i]]);
  }
  some.picture = all.picture;
  for (int64_t& row : some.picture.row) row = row < 0 ? -1 : number[row];
  return some;
}

std::vector<int64_t> RowsOfGround(const TransportRows& mesh) {
  std::map<int, int64_t> counts;
  for (const Eigen::Vector3f& p : mesh.positions) ++counts[static_cast<int>(std::lround(p.z()))];
  const auto most =
      std::max_element(counts.begin(), counts.end(),
                       [](const auto& a, const auto& b) { return a.second < b.second; });
  std::vector<int64_t> rows;
  for (size_t i = 0; i < mesh.positions.size(); ++i) {
    if (std::lround(mesh.positions[i].z()) == most->first) rows.push_back(static_cast<int64_t>(i));
  }
  return rows;
}

TransportRows HalfSize(const TransportRows& image) {
  const int width = image.picture.width / 2, height = image.picture.height / 2;
  TransportRows half;
  half.name = image.name;
  half.picture = {width, height, std::vector<int64_t>(static_cast<size_t>(width) * height, -1)};
  half.rows = MakeFunctionRows(image.rows.rows / 4, image.rows.columns);
  int64_t count = 0;
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      int64_t rows[4];
      for (int i = 0; i < 4; ++i) {
        rows[i] = image.picture.row[int64_t{2 * y + i / 2} * image.picture.width + 2 * x + i % 2];
      }
      if (*std::min_element(rows, rows + 4) < 0) continue;
      float* out = half.rows.Row(count);
      for (const int64_t row : rows) {
        for (int j = 0; j < half.rows.columns; ++j) out[j] += 0.25f * image.rows.Row(row)[j];
      }
      half.positions.push_back({static_cast<float>(x), static_cast<float>(y), 0});
      half.picture.row[int64_t{y} * width + x] = count++;
    }
  }
  half.rows.rows = count;
  half.rows.values.resize(static_cast<size_t>(count) * half.rows.stride);
  return half;
}

TransportRows CoarserLight(const TransportRows& all) {
  const ColumnGrid grid = GridOfColumns(all.rows.columns);
  if (grid.faces != 6 || grid.width % 2 != 0) throw Error("no cube map of an even resolution");
  TransportRows coarser;
  coarser.name = all.name;
  coarser.picture = all.picture;
  coarser.positions = all.positions;
  coarser.rows = MakeFunctionRows(all.rows.rows, all.rows.columns / 4);
  for (int64_t row = 0; row < all.rows.rows; ++row) {
    for (int j = 0; j < all.rows.columns; ++j) {
      const int line = j / grid.width, column = j % grid.width;  // of all faces
      coarser.rows.Row(row)[line / 2 * (grid.width / 2) + column / 2] += all.rows.Row(row)[j];
    }
  }
  return coarser;
}

}  // namespace lfm::bench
