// SPDX-License-Identifier: BSD-3-Clause
#include "fields/transport_reading.h"

#include <cmath>
#include <numeric>
#include <string>

#include "core/cube_map.h"
#include "core/error.h"
#include "core/parallel.h"
#include "core/ply.h"
#include "core/transport_matrix.h"
#include "fields/matrix_room.h"

namespace lfm {
namespace {

std::filesystem::path FileInside(const Capture& capture, const std::string& file) {
  const std::string problem = CapturePathProblem(capture.folder, file);
  if (!problem.empty()) throw Error(capture.folder.string() + ": " + problem);
  return capture.folder / file;
}

void RequireRows(const TransportShape& shape, int64_t points, int64_t views,
                 const std::string& file, const std::string& where) {
  if (shape.points == points && shape.views == views) return;
  throw Error(file + ": has " + std::to_string(shape.points) + " points in " +
              std::to_string(shape.views) + " views, but " + where + " has " +
              std::to_string(points) + " in " + std::to_string(views) +
              "; the two are not of one capture");
}

void RequireCube(const TransportShape& shape, int resolution, const std::string& file) {
  if (shape.cube_resolution == resolution) return;
  throw Error(file + ": its cube map has " + std::to_string(shape.cube_resolution) +
              " texels a side, but the manifest says " + std::to_string(resolution));
}

// What the rows of the matrix are: pixels, or vertices with positions.
struct Points {
  int width = 0, height = 0;
  std::vector<Eigen::Vector3f> positions;  // of one view
};

Points PointsOf(const Capture& capture, const TransportShape& shape, const std::string& file) {
  const TransportField& transport = *capture.transport;
  Points points;
  if (transport.kind == TransportKind::kImage) {
    const auto camera = capture.cameras.find(transport.camera);
    if (camera == capture.cameras.end()) {
      throw Error(capture.folder.string() + ": the transport's camera '" + transport.camera +
                  "' is not listed");
    }
    points.width = camera->second.width;
    points.height = camera->second.height;
    RequireRows(shape, int64_t{points.width} * points.height, 1, file,
                "camera '" + transport.camera + "'");
    return points;
  }
  const std::filesystem::path mesh_file = FileInside(capture, transport.mesh);
  for (const Eigen::Vector3d& vertex : ReadPlyMesh(mesh_file).vertices) {
    points.positions.push_back(vertex.cast<float>());
  }
  RequireRows(shape, static_cast<int64_t>(points.positions.size()),
              static_cast<int64_t>(transport.eyes.size()), file, mesh_file.string());
  return points;
}

// Rows `which[begin]` to `which[end - 1]`, those that follow each other in one go.
void CopyRows(const TransportMatrix& matrix, const std::vector<int64_t>& which, int64_t begin,
              int64_t end, const std::string& file, Field& field) {
  const TransportShape& shape = matrix.shape();
  for (int64_t i = begin; i < end;) {
    int64_t next = i + 1;
    while (next < end && which[next] == which[next - 1] + 1) ++next;
    const std::vector<float> values = matrix.ReadRows(which[i], next - i);
    const float* in = values.data();
    for (int64_t point = i; point < next; ++point) {
      for (int channel = 0; channel < shape.channels; ++channel) {
        float* out = field.functions.Row(field.RowOf(point, channel));
        for (int64_t column = 0; column < shape.columns(); ++column) {
          out[column] = *in++;
          if (std::isfinite(out[column])) continue;
          throw Error(file + ": row " + std::to_string(which[point]) + ", column " +
                      std::to_string(column) + " is not finite; make the matrix again");
        }
      }
    }
    i = next;
  }
}

std::vector<int64_t> AllRows(int64_t count) {
  std::vector<int64_t> rows(static_cast<size_t>(count));
  std::iota(rows.begin(), rows.end(), int64_t{0});
  return rows;
}

void RequireRowsThere(const std::vector<int64_t>& which, int64_t count, const std::string& file) {
  for (const int64_t row : which) {
    if (row >= 0 && row < count) continue;
    throw Error(file + ": has no point " + std::to_string(row) + " among its " +
                std::to_string(count));
  }
}

}  // namespace

Field ReadTransportField(const Capture& capture, const std::vector<int64_t>& which,
                         Progress& progress) {
  constexpr int64_t kChunk = 64;
  if (!capture.transport) {
    throw Error(capture.folder.string() + ": the capture has no light transport");
  }
  const std::filesystem::path path = FileInside(capture, capture.transport->file);
  const std::string file = path.string();
  const TransportMatrix matrix(path);
  const TransportShape& shape = matrix.shape();
  RequireCube(shape, capture.transport->cube_resolution, file);
  const Points points = PointsOf(capture, shape, file);
  RequireRowsThere(which, shape.rows(), file);
  const std::vector<int64_t> rows = which.empty() ? AllRows(shape.rows()) : which;

  Field field;
  field.name = capture.name.empty() ? capture.folder.string() : capture.name;
  field.kind = FieldColumns::kCubeTexels;
  field.points = static_cast<int64_t>(rows.size());
  field.channels = shape.channels;
  if (which.empty()) {
    field.width = points.width;
    field.height = points.height;
  }
  const auto vertices = static_cast<int64_t>(points.positions.size());
  if (vertices > 0) {
    for (const int64_t row : rows) field.positions.push_back(points.positions[row % vertices]);
  }
  const CubeMap cube{shape.cube_resolution};
  for (int t = 0; t < cube.Texels(); ++t) {
    field.directions.push_back(cube.Point(t, 0.5F, 0.5F).cast<double>().normalized());
  }
  RequireRoom(field.points * field.channels, shape.columns(), file,
              "or read some of its points only");
  field.functions =
      MakeFunctionRows(field.points * field.channels, static_cast<int>(shape.columns()));
  progress.Start("reading light transport", field.points);
  ParallelChunks(field.points, kChunk, [&](int64_t begin, int64_t end, int64_t) {
    CopyRows(matrix, rows, begin, end, file, field);
    progress.Advance(end - begin);
  });
  return field;
}

}  // namespace lfm
