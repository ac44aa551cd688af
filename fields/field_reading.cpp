// SPDX-License-Identifier: BSD-3-Clause
#include "fields/field_reading.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "core/error.h"
#include "core/parallel.h"
#include "fields/matrix_room.h"
#include "fields/picture_window.h"

namespace lfm {
namespace {

struct Source {
  const Capture& capture;
  const ReflectanceField& field;
  const ImageLoader& load;
  const PictureWindow& window;

  std::string Name(const std::string& file) const { return (capture.folder / file).string(); }
};

const ReflectanceField& FieldOf(const Capture& capture) {
  if (!capture.reflectance_field) {
    throw Error(capture.folder.string() +
                ": the capture has no reflectance field; it is read from "
                "one camera's pictures under many lights");
  }
  return *capture.reflectance_field;
}

const CaptureCamera& CameraOf(const Capture& capture, const ReflectanceField& field) {
  const auto camera = capture.cameras.find(field.camera);
  if (camera == capture.cameras.end()) {
    throw Error(capture.folder.string() + ": the reflectance field's camera '" + field.camera +
                "' is not listed");
  }
  return camera->second;
}

std::vector<const LitPicture*> PicturesOf(const ReflectanceField& field, PhotoSplit split) {
  std::vector<const LitPicture*> pictures;
  for (const LitPicture& picture : field.pictures) {
    if (picture.split == split) pictures.push_back(&picture);
  }
  return pictures;
}

Eigen::Vector3d DirectionOf(const Source& source, const LitPicture& picture) {
  constexpr double kUnitLength_abs = 1e-5;
  if (!(std::abs(picture.to_light.norm() - 1) <= kUnitLength_abs)) {
    throw Error(source.Name(picture.file) +
                ": its light direction is no unit vector; divide it by its length");
  }
  return picture.to_light.normalized();
}

// Columns [first, first + batch) of the matrix: a whole line of the cache of every row at once.
void PutColumns(const std::vector<PictureColumn>& columns, int first, FunctionRows& rows) {
  constexpr int64_t kChunk = 4096;
  ParallelChunks(rows.rows, kChunk, [&](int64_t begin, int64_t end, int64_t) {
    for (int64_t row = begin; row < end; ++row) {
      float* out = rows.Row(row) + first;
      for (const PictureColumn& column : columns) *out++ = column.values[static_cast<size_t>(row)];
    }
  });
}

// The channels that all pictures of a field have, and whose picture said so.
struct Channels {
  int count = 0;
  std::string said_by;
};

void RequireSameChannels(const Channels& channels, int count, const std::string& name) {
  if (channels.count == count) return;
  throw Error(name + ": has " + std::to_string(count) + " colour channel(s), but " +
              channels.said_by + " has " + std::to_string(channels.count) +
              "; save all pictures in gray or all in RGB");
}

void RequireRoomOfPictures(int64_t rows, int64_t columns, const std::string& name) {
  RequireRoom(rows, columns, name, "or read less with field-reduce or a crop");
}

struct ReadMatrix {
  Field field;
  std::vector<std::string> files;
  int64_t negative = 0;
};

ReadMatrix ReadPictures(const Source& source, const std::vector<const LitPicture*>& pictures,
                        Channels& channels, Progress& progress) {
  ReadMatrix result;
  Field& field = result.field;
  field.name = source.capture.name.empty() ? source.capture.folder.string() : source.capture.name;
  field.kind = FieldColumns::kLights;
  field.points = source.window.points();
  field.width = source.window.width;
  field.height = source.window.height;
  field.mask = source.window.point_counts;
  for (const LitPicture* picture : pictures) {
    field.directions.push_back(DirectionOf(source, *picture));
    result.files.push_back(picture->file);
  }
  const int count = static_cast<int>(pictures.size());
  // Before pictures are read that are in vain.
  RequireRoomOfPictures(field.points, count, field.name);
  for (int first = 0; first < count; first += FunctionRows::kLane) {
    const int batch = std::min(FunctionRows::kLane, count - first);
    std::vector<PictureColumn> columns(static_cast<size_t>(batch));
    ParallelFor(0, batch, [&](int64_t i) {
      const LitPicture& picture = *pictures[static_cast<size_t>(first + i)];
      columns[static_cast<size_t>(i)] = ReadColumn(source.load(picture.file), picture.intensity,
                                                   source.window, source.Name(picture.file));
      progress.Advance();
    });
    if (channels.count == 0) {
      channels = {columns.front().channels, source.Name(pictures.front()->file)};
    }
    if (first == 0) {
      RequireRoomOfPictures(field.points * channels.count, count, field.name);
      field.functions = MakeFunctionRows(field.points * channels.count, count);
    }
    for (int i = 0; i < batch; ++i) {
      const size_t index = static_cast<size_t>(i);
      RequireSameChannels(channels, columns[index].channels,
                          source.Name(pictures[static_cast<size_t>(first + i)]->file));
      result.negative += columns[index].negative;
    }
    PutColumns(columns, first, field.functions);
  }
  field.channels = channels.count;
  return result;
}

bool IsBlack(const Field& field) {
  for (const float value : field.functions.values) {
    if (value != 0) return false;
  }
  return true;
}

// Pairs of equal directions, each direction counted with the one before it in a sorted order.
int64_t RepeatedDirections(const std::vector<Eigen::Vector3d>& directions) {
  constexpr double kSame_abs = 1e-6;
  std::vector<size_t> order(directions.size());
  std::iota(order.begin(), order.end(), size_t{0});
  std::sort(order.begin(), order.end(),
            [&](size_t a, size_t b) { return directions[a].x() < directions[b].x(); });
  int64_t repeated = 0;
  for (size_t i = 0; i < order.size(); ++i) {
    for (size_t k = i; k-- > 0;) {
      if (directions[order[i]].x() - directions[order[k]].x() > kSame_abs) break;
      if ((directions[order[i]] - directions[order[k]]).norm() <= kSame_abs) {
        ++repeated;
        break;
      }
    }
  }
  return repeated;
}

void NoteExtremes(const ReadMatrix& train, int64_t negative, Progress& progress) {
  const Field& field = train.field;
  const std::string lights = std::to_string(field.directions.size()) + " lights";
  const int64_t repeated = RepeatedDirections(field.directions);
  const auto below = std::count_if(field.directions.begin(), field.directions.end(),
                                   [](const Eigen::Vector3d& d) { return d.z() < 0; });
  if (negative > 0) {
    progress.Note(field.name + ": " + std::to_string(negative) +
                  " negative values were set to zero");
  }
  if (repeated > 0) {
    progress.Note(field.name + ": " + std::to_string(repeated) + " of " + lights +
                  " have the direction of another; each keeps its column");
  }
  if (below > 0) {
    progress.Note(field.name + ": " + std::to_string(below) + " of " + lights +
                  " lie below the horizon (z < 0)");
  }
  if (IsBlack(field)) progress.Note(field.name + ": every picture is black");
}

}  // namespace

ReflectanceFieldData ReadReflectanceField(const Capture& capture, const ImageLoader& load,
                                          const FieldReadOptions& options, Progress& progress) {
  FieldReadOptions checked = options;
  ValidateOptions(AnyOptions(checked));
  const ReflectanceField& field = FieldOf(capture);
  const CaptureCamera& camera = CameraOf(capture, field);
  const std::string name = capture.folder.string();
  PictureWindow window = MakeWindow(camera.width, camera.height, options, name);
  if (!field.mask.empty()) {
    window = WithMask(std::move(window), load(field.mask), (capture.folder / field.mask).string());
  }
  const std::vector<const LitPicture*> train = PicturesOf(field, PhotoSplit::kTrain);
  if (train.empty()) {
    throw Error(name + ": the reflectance field has no training picture; mark some as \"train\"");
  }
  const Source source{capture, field, load, window};
  progress.Start("reading pictures", static_cast<int64_t>(field.pictures.size()));
  Channels channels;
  ReadMatrix read = ReadPictures(source, train, channels, progress);
  ReadMatrix held_out =
      ReadPictures(source, PicturesOf(field, PhotoSplit::kTest), channels, progress);
  NoteExtremes(read, read.negative + held_out.negative, progress);
  ReflectanceFieldData data;
  data.train = std::move(read.field);
  data.train_files = std::move(read.files);
  data.held_out = std::move(held_out.field);
  data.held_out_files = std::move(held_out.files);
  data.camera = field.camera;
  if (camera.intrinsics) data.intrinsics = CameraOfWindow(*camera.intrinsics, window);
  data.camera_from_world = field.camera_from_world;
  return data;
}

ReflectanceFieldData ReadReflectanceField(const Capture& capture, const FieldReadOptions& options,
                                          Progress& progress) {
  return ReadReflectanceField(capture, MakeImageLoader(capture), options, progress);
}

}  // namespace lfm
