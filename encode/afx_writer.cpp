// SPDX-License-Identifier: BSD-3-Clause
// Pictures are written with the first row of a page at the bottom: texture coordinates of VRML run
// upwards, and so does y = (d.y + 1) / 2 of a view map then.
#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include "core/error.h"
#include "core/parallel.h"
#include "encode/afx.h"
#include "encode/afx_layout.h"
#include "encode/afx_pictures.h"
#include "encode/afx_text.h"
#include "encode/glb_format.h"
#include "encode/shared_samples.h"
#include "encode/tiling.h"

namespace lfm {
namespace {

// A part of a page as a picture: one channel, or all of them.
struct Tile {
  std::string name;
  const Image* page = nullptr;
  int channel = -1;
};

Image Picture(const Tile& tile) {
  const Image& page = *tile.page;
  const int channels = tile.channel < 0 ? page.channels() : 1;
  Image picture(page.width(), page.height(), channels, PixelType::kUint8, ColorEncoding::kSrgb);
  for (int y = 0; y < page.height(); ++y) {
    for (int x = 0; x < page.width(); ++x) {
      std::copy_n(&page.At<uint8_t>(x, y, std::max(0, tile.channel)), channels,
                  &picture.At<uint8_t>(x, page.height() - 1 - y));
    }
  }
  return picture;
}

// All pictures of a model, and their numbers.
struct Tiles {
  std::vector<Tile> list;
  std::vector<std::vector<int>> surface, view;  // [term][page]; surface: of the first channel

  explicit Tiles(const LightFieldModel& model) {
    const auto add = [this](const Image& page, const std::string& name, int channel) {
      list.push_back({name, &page, channel});
      return static_cast<int>(list.size()) - 1;
    };
    for (size_t p = 0; p < model.mean_pages.size(); ++p) {
      add(model.mean_pages[p], "mean-" + std::to_string(p), -1);
    }
    surface.resize(model.terms);
    view.resize(model.terms);
    for (int k = 0; k < model.terms; ++k) {
      const std::string of_term = "-" + std::to_string(k + 1) + "-";
      for (size_t p = 0; p < model.surface_pages[k].size(); ++p) {
        const std::string name = "surface" + of_term + std::to_string(p);
        surface[k].push_back(add(model.surface_pages[k][p], name + "-a", 0));
        add(model.surface_pages[k][p], name + "-b", 1);
        add(model.surface_pages[k][p], name + "-c", 2);
      }
      for (size_t p = 0; p < model.view_pages[k].size(); ++p) {
        view[k].push_back(add(model.view_pages[k][p], "view" + of_term + std::to_string(p), -1));
      }
    }
  }
};

// A light map of a term: the vertices whose maps have one range.
struct LightMap {
  int term = 0;
  MapRange range;
  std::vector<int> vertices;
  std::vector<int> entry;  // of each vertex of the model in `vertices`, or -1
};

std::vector<LightMap> FindLightMaps(const LightFieldModel& model) {
  const size_t vertices = model.vertex_terms.size();
  std::vector<LightMap> light_maps;
  for (int k = 0; k < model.terms; ++k) {
    const auto range_of = [&](size_t v) {
      const MapRange& range = model.surface_ranges[k * vertices + v];
      return std::pair(-range.scale, range.bias);  // the widest come first
    };
    std::set<std::pair<float, float>> ranges;
    for (size_t v = 0; v < vertices; ++v) {
      if (model.vertex_terms[v] > k) ranges.insert(range_of(v));
    }
    for (const auto& range : ranges) {
      LightMap map{k, {-range.first, range.second}, {}, std::vector<int>(vertices, -1)};
      for (size_t v = 0; v < vertices; ++v) {
        if (model.vertex_terms[v] <= k || range_of(v) != range) continue;
        map.entry[v] = static_cast<int>(map.vertices.size());
        map.vertices.push_back(static_cast<int>(v));
      }
      light_maps.push_back(std::move(map));
    }
  }
  return light_maps;
}

class Writer {
 public:
  explicit Writer(const LightFieldModel& model)
      : model_(model), tiles_(model), light_maps_(FindLightMaps(model)) {}

  AfxFiles Write() {
    AfxFiles files;
    EncodePictures(files);
    text_ = afx::kPrologue;
    WriteView();
    text_ +=
        "Transform { # millimetres, z up\n  rotation 1 0 0 -1.5707964\n"
        "  scale 0.001 0.001 0.001\n  children [\n";
    for (int page = 0; page < static_cast<int>(model_.mean_pages.size()); ++page) {
      WriteShape(files, page);
    }
    text_ += "  ]\n}\n";
    files.wrl = std::move(text_);
    return files;
  }

 private:
  void EncodePictures(AfxFiles& files) const {
    files.pictures.resize(tiles_.list.size());
    ParallelFor(0, static_cast<int64_t>(tiles_.list.size()), [&](int64_t i) {
      AfxFiles::Picture& picture = files.pictures[i];
      picture.png = EncodePng(Picture(tiles_.list[i]), glb::kPngCompression);
      const std::string_view bytes(reinterpret_cast<const char*>(picture.png.data()),
                                   picture.png.size());
      picture.name =
          std::string(afx::kPictureFolder) + "/" + afx::PictureFile(tiles_.list[i].name, bytes);
    });
  }

  // The object from the front, as large as the picture.
  void WriteView() {
    Eigen::Vector3d low = model_.mesh.vertices.front(), high = low;
    for (const Eigen::Vector3d& p : model_.mesh.vertices) {
      low = low.cwiseMin(p);
      high = high.cwiseMax(p);
    }
    const Eigen::Vector3d center = (low + high) / 2;
    constexpr double kHalfFieldOfView = 0.3926991;  // VRML's default, half of pi / 4
    const double distance = (high - low).norm() / 2 / std::sin(kHalfFieldOfView);
    text_ +=
        "NavigationInfo { type [\"EXAMINE\" \"ANY\"] avatarSize [0.01 1.6 0.75] }\n"
        "Viewpoint { description \"front\" position ";
    for (const double mm : {center.x(), center.z(), -center.y() + distance}) {
      afx::Append(text_, static_cast<float>(1e-3 * mm));
      text_ += ' ';
    }
    text_ += "}\n";
  }

  std::string PlaneCoordinates(const std::vector<float>& values, int values_per_line) {
    return nodes_.Node("COORDINATES_",
                       "TextureCoordinate { point " + afx::List(values, values_per_line) + " }");
  }

  // Where corner c of a patch lies, as texture coordinates of its page.
  static void AppendCorners(const PatchPlacement& placement, const Image& page,
                            std::vector<float>& values) {
    const int last = placement.edge_samples - 1;
    for (int c = 0; c < 3; ++c) {
      const Eigen::Vector2i texel = TexelOfSample(placement, c == 1 ? last : 0, c == 2 ? last : 0);
      values.push_back(static_cast<float>((texel.x() + 0.5) / page.width()));
      values.push_back(static_cast<float>((texel.y() + 0.5) / page.height()));
    }
  }

  void WriteShape(const AfxFiles& files, int page) {
    std::vector<int> triangles, coord_index, texture_index;
    std::vector<float> corners;
    for (int t = 0; t < static_cast<int>(model_.placements.size()); ++t) {
      if (model_.placements[t].page != page) continue;
      const auto first = static_cast<int>(3 * triangles.size());
      triangles.push_back(t);
      const Eigen::Vector3i& vertices = model_.mesh.triangles[t];
      coord_index.insert(coord_index.end(), {vertices[0], vertices[1], vertices[2], -1});
      texture_index.insert(texture_index.end(), {first, first + 1, first + 2, -1});
      AppendCorners(model_.placements[t], model_.mean_pages[page], corners);
    }
    std::vector<float> points;
    for (const Eigen::Vector3d& p : model_.mesh.vertices) {
      for (const double value : p) points.push_back(static_cast<float>(value));
    }
    // One node a statement: in a sum a later one could be named before an earlier one.
    text_ += "Shape {\ngeometry IndexedFaceSet {\ncoord " +
             nodes_.Node("POINTS_", "Coordinate { point " + afx::List(points, 3) + " }");
    text_ +=
        "\ncoordIndex " + afx::List(coord_index, 4) + "\ntexCoord " + PlaneCoordinates(corners, 6);
    text_ += "\ntexCoordIndex " + afx::List(texture_index, 4) +
             "\n}\nappearance LFM_Appearance {\ntileList [\n";
    for (const AfxFiles::Picture& picture : files.pictures) text_ += TileNode(picture) + "\n";
    text_ += "]\ntexture " + TileNode(files.pictures[page]) + "\nlightMapList [\n";
    WriteMeanMap(page, triangles, corners);
    for (size_t i = 0; i < light_maps_.size(); ++i) WriteLightMap(i, triangles, page);
    text_ += "]\n";
    WriteBlendList();
    WriteFrames();
    text_ += "}\n}\n";
  }

  std::string TileNode(const AfxFiles::Picture& picture) {
    return nodes_.Node("TILE_",
                       "ImageTexture { url \"" + picture.name + "\" repeatS FALSE repeatT FALSE }");
  }

  void WriteMeanMap(int page, const std::vector<int>& triangles,
                    const std::vector<float>& corners) {
    std::vector<int> index(triangles.size());
    for (size_t i = 0; i < index.size(); ++i) index[i] = static_cast<int>(i);
    text_ += "LFM_LightMap { # mean view\nsurfaceMapList " +
             SurfaceMapList(index, std::vector<int>(index.size(), page),
                            std::vector<int>(index.size(), -1), corners) +
             "\npriorityLevel 0\n}\n";
  }

  std::string SurfaceMapList(const std::vector<int>& triangles, const std::vector<int>& tiles,
                             const std::vector<int>& view_maps, const std::vector<float>& corners) {
    return "LFM_SurfaceMapList {\ntriangleIndex " + afx::List(triangles, 24) + "\ntileIndex " +
           afx::List(tiles, 24) + "\nviewMapIndex " + afx::List(view_maps, 24) +
           "\ntriangleCoordinate " + PlaneCoordinates(corners, 6) + "\n}";
  }

  void WriteLightMap(size_t number, const std::vector<int>& triangles, int page) {
    const LightMap& map = light_maps_[number];
    std::vector<int> indices, tiles, view_maps;
    std::vector<float> corners;
    for (size_t i = 0; i < triangles.size(); ++i) {
      const Eigen::Vector3i& vertices = model_.mesh.triangles[triangles[i]];
      const PatchPlacement& placement = model_.placements[triangles[i]];
      for (int c = 0; c < 3; ++c) {
        const int entry = map.entry[vertices[c]];
        // A corner that repeats a vertex has no map of its own.
        if (entry < 0 || CornerOf(vertices, vertices[c]) != c) continue;
        indices.push_back(static_cast<int>(i));
        tiles.push_back(tiles_.surface[map.term][placement.page] + c);
        view_maps.push_back(entry);
        AppendCorners(placement, model_.surface_pages[map.term][placement.page], corners);
      }
    }
    text_ += "LFM_LightMap { # term " + std::to_string(map.term + 1) + "\nsurfaceMapList " +
             SurfaceMapList(indices, tiles, view_maps, corners) + "\nviewMapList ";
    // One list for all shapes: they share their vertices.
    const std::string name = "VIEWS_" + std::to_string(number + 1);
    text_ += page == 0 ? "DEF " + name + " " + ViewMapList(map) : "USE " + name;
    text_ += "\nscaleRGB";
    AppendThrice(map.range.scale);
    text_ += "\nbiasRGB";
    AppendThrice(map.range.bias);
    text_ += "\npriorityLevel " + std::to_string(map.term + 1) + "\n}\n";
  }

  void AppendThrice(float value) {
    for (int c = 0; c < 3; ++c) {
      text_ += ' ';
      afx::Append(text_, value);
    }
  }

  std::string ViewMapList(const LightMap& map) {
    std::vector<int> tiles;
    std::vector<float> origins, sizes;
    for (const int v : map.vertices) {
      const LightFieldModel::TilePosition tile = model_.ViewTile(0, v);
      const Image& page = model_.view_pages[map.term][tile.page];
      const auto width = static_cast<float>(page.width());
      const auto height = static_cast<float>(page.height());
      const auto last = static_cast<float>(model_.grid - 1);
      tiles.push_back(tiles_.view[map.term][tile.page]);
      origins.insert(origins.end(), {(static_cast<float>(tile.x) + 0.5f) / width,
                                     (static_cast<float>(tile.y) + 0.5f) / height});
      sizes.insert(sizes.end(), {last / width, last / height});
    }
    std::string text = "LFM_ViewMapList {\nvertexIndex " + afx::List(map.vertices, 24) +
                       "\ntileIndex " + afx::List(tiles, 24) + "\ntextureOrigin " +
                       PlaneCoordinates(origins, 8);
    text += "\ntextureSize " + PlaneCoordinates(sizes, 8);
    if (model_.direction_map != DirectionMap::kOrthographic) {
      text += std::string("\ndirectionMap \"") +
              glb::kDirectionMapNames[static_cast<int>(model_.direction_map)] + "\"";
    }
    return text + "\n}";
  }

  void WriteBlendList() {
    std::vector<int> index(light_maps_.size() + 1), add(index.size(), 0);
    for (size_t i = 0; i < index.size(); ++i) index[i] = static_cast<int>(i);
    text_ += "blendList " +
             nodes_.Node("BLEND_", "LFM_BlendList {\nlightMapIndex " + afx::List(index, 24) +
                                       "\nblendMode " + afx::List(add, 24) + "\n}") +
             "\n";
  }

  void WriteFrames() {
    std::vector<int> index;
    std::vector<float> axes;
    for (const Eigen::Matrix3d& frame : model_.vertex_frames) {
      index.push_back(static_cast<int>(index.size()));
      for (const double value : frame.reshaped()) axes.push_back(static_cast<float>(value));
    }
    text_ += "vertexFrameList " +
             nodes_.Node("FRAMES_", "LFM_FrameList {\nindex " + afx::List(index, 24) + "\nframe " +
                                        afx::List(axes, 9) + "\n}") +
             "\n";
  }

  const LightFieldModel& model_;
  Tiles tiles_;
  std::vector<LightMap> light_maps_;
  afx::NodeTexts nodes_;
  std::string text_;
};

}  // namespace

AfxFiles WriteAfxForm(const LightFieldModel& model) {
  ValidateModel(model, "the model");
  if (model.mean_in_terms || !HasSharedRanges(model)) {
    throw Error("the model is not of AFX form", ErrorKind::kSystem);
  }
  return Writer(model).Write();
}

}  // namespace lfm
