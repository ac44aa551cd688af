// SPDX-License-Identifier: BSD-3-Clause
// Several shapes may share vertices (one Coordinate node), view maps (one LFM_ViewMapList) and
// tiles: they are counted once.
#include "encode/afx_content.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include "encode/glb_format.h"
#include "encode/vrml_fields.h"
#include "encode/vrml_tokens.h"

namespace lfm::afx {
namespace {

using vrml::Node;

constexpr float kMostRange = 1e6f;  // of a map's values; products stay finite

class Collector {
 public:
  Collector(const vrml::Scene& scene, const std::string& name, const AfxReadOptions& options)
      : scene_(scene), fields_(scene, name), options_(options) {}

  Content Collect() {
    for (const int shape : Shapes()) AddShape(fields_.At(shape));
    fields_.Require(!content_.mesh.triangles.empty(), 1,
                    "no shape has an LFM_Appearance: not a light field model");
    return std::move(content_);
  }

 private:
  struct Range {
    int first = 0, count = 0;
  };

  // Every Shape of the scene with a light field, once, in the order of the file.
  std::vector<int> Shapes() const {
    std::vector<int> shapes, pending(scene_.roots.rbegin(), scene_.roots.rend());
    std::vector<bool> seen(scene_.nodes.size(), false);
    while (!pending.empty()) {
      const int at = pending.back();
      pending.pop_back();
      if (seen[at]) continue;
      seen[at] = true;
      const Node& node = fields_.At(at);
      if (node.type == "Shape") {
        const int appearance = fields_.Child(node, "appearance");
        if (appearance >= 0 && fields_.At(appearance).type == "LFM_Appearance")
          shapes.push_back(at);
        continue;
      }
      for (auto field = node.fields.rbegin(); field != node.fields.rend(); ++field) {
        pending.insert(pending.end(), field->value.nodes.rbegin(), field->value.nodes.rend());
      }
    }
    return shapes;
  }

  void AddShape(const Node& shape) {
    const int geometry = fields_.Child(shape, "geometry", "IndexedFaceSet");
    fields_.Require(geometry >= 0, shape.line, "a light field has no geometry");
    const int appearance_node = fields_.Child(shape, "appearance");
    // What a file says once is read once: else a short one could ask for any amount of work.
    fields_.Require(used_.insert(geometry).second && used_.insert(appearance_node).second,
                    shape.line, "two light fields have one face set or one LFM_Appearance");
    first_triangle_ = static_cast<int>(content_.mesh.triangles.size());
    AddGeometry(fields_.At(geometry));
    const Node& appearance = fields_.At(appearance_node);
    AddFrames(appearance);
    AddTiles(appearance);
    const std::vector<int> maps = fields_.Children(appearance, "lightMapList", "LFM_LightMap");
    const std::vector<bool> subtracted = Subtracted(appearance, maps.size());
    for (size_t i = 0; i < maps.size(); ++i) AddLightMap(fields_.At(maps[i]), subtracted[i]);
  }

  void AddGeometry(const Node& faces) {
    coordinate_ = fields_.Child(faces, "coord", "Coordinate");
    fields_.Require(coordinate_ >= 0, faces.line, "a face set has no coordinates");
    fields_.Require(fields_.Flag(faces, "ccw", true), faces.line,
                    "faces that run clockwise (ccw FALSE) are not read");
    const auto first = static_cast<int>(content_.mesh.vertices.size());
    const auto [place, is_new] = vertices_.try_emplace(coordinate_, Range{first, 0});
    if (is_new) {
      const std::vector<float> points = fields_.Floats(fields_.At(coordinate_), "point", 3);
      for (size_t i = 0; i < points.size(); i += 3) {
        content_.mesh.vertices.emplace_back(points[i], points[i + 1], points[i + 2]);
      }
      place->second.count = static_cast<int>(points.size() / 3);
      content_.given_frames.resize(content_.mesh.vertices.size(), Eigen::Matrix3d::Zero());
    }
    first_vertex_ = place->second.first;
    const int count = vertex_count_ = place->second.count;
    const std::vector<int> index = fields_.Integers(faces, "coordIndex");
    for (size_t i = 0; i < index.size(); i += 4) {
      const bool whole = i + 3 <= index.size() && (i + 3 == index.size() || index[i + 3] == -1);
      fields_.Require(whole, faces.line, "a face is not a triangle");
      Eigen::Vector3i triangle(index[i], index[i + 1], index[i + 2]);
      fields_.Require(triangle.minCoeff() >= 0 && triangle.maxCoeff() < count, faces.line,
                      "a triangle names a vertex that is not there");
      triangle.array() += first_vertex_;
      content_.mesh.triangles.push_back(triangle);
    }
    triangle_count_ = static_cast<int>(content_.mesh.triangles.size()) - first_triangle_;
  }

  void AddFrames(const Node& appearance) {
    const int list = fields_.Child(appearance, "vertexFrameList", "LFM_FrameList");
    if (list < 0 || !frame_lists_.emplace(list, coordinate_).second) return;
    const Node& frames = fields_.At(list);
    const std::vector<int> index = fields_.Integers(frames, "index", {-1});
    const std::vector<float> axes = fields_.Floats(frames, "frame", 9, {1, 0, 0, 0, 1, 0, 0, 0, 1});
    fields_.Require(axes.size() == 9 * index.size(), frames.line,
                    "there are not three axes for each index of a frame list");
    for (size_t i = 0; i < index.size(); ++i) {
      if (index[i] == -1) continue;  // names no vertex, as the default does
      fields_.Require(index[i] >= 0 && index[i] < vertex_count_, frames.line,
                      "a frame names a vertex that is not there");
      const Eigen::Matrix3d frame =
          Eigen::Map<const Eigen::Matrix3f>(axes.data() + 9 * i).cast<double>();
      constexpr double kOrthonormal_abs = 1e-3;
      fields_.Require(
          (frame.transpose() * frame - Eigen::Matrix3d::Identity()).norm() < kOrthonormal_abs,
          frames.line, "the axes of a frame are not of length 1 at right angles");
      content_.given_frames[first_vertex_ + index[i]] = frame;
    }
  }

  void AddTiles(const Node& appearance) {
    shape_tiles_.clear();
    for (const int texture : fields_.Children(appearance, "tileList", "ImageTexture")) {
      const Node& node = fields_.At(texture);
      const std::string name = fields_.String(node, "url", "");
      const auto [place, is_new] =
          tile_numbers_.try_emplace(name, static_cast<int>(content_.tiles.size()));
      if (is_new) content_.tiles.push_back({name, node.line});
      shape_tiles_.push_back(place->second);
    }
  }

  std::vector<bool> Subtracted(const Node& appearance, size_t count) const {
    std::vector<bool> subtracted(count, false);
    int list = fields_.Child(appearance, "blendList");
    if (list < 0) return subtracted;
    const Node& blend = fields_.At(list);
    fields_.Require(blend.type == "LFM_BlendList" || blend.type == "LFM_blendList", blend.line,
                    "blendList is not a node LFM_BlendList");
    const std::vector<int> index = fields_.Integers(blend, "lightMapIndex");
    const std::vector<int> mode = fields_.Integers(blend, "blendMode");
    fields_.Require(index.size() == mode.size() && index.size() <= count, blend.line,
                    "there is not one blend mode for each light map of a blend list");
    for (size_t i = 0; i < index.size(); ++i) {
      fields_.Require(index[i] >= 0 && static_cast<size_t>(index[i]) < count, blend.line,
                      "a blend list names a light map that is not there");
      fields_.Require(mode[i] == 0 || mode[i] == 1, blend.line,
                      "a blend mode is neither 0 (LFM_ADD) nor 1 (LFM_SUBTRACT)");
      subtracted[index[i]] = mode[i] == 1;
    }
    return subtracted;
  }

  Eigen::Vector3f Color(const Node& node, const char* field, float fallback) const {
    const std::vector<float> values =
        fields_.Floats(node, field, 3, {fallback, fallback, fallback});
    fields_.Require(values.size() == 3, node.line, std::string(field) + " is not one colour");
    const Eigen::Vector3f color(values[0], values[1], values[2]);
    fields_.Require(color.cwiseAbs().maxCoeff() <= kMostRange, node.line,
                    std::string(field) + " is larger than 1e6");
    return color;
  }

  void AddLightMap(const Node& node, bool subtracted) {
    const std::vector<int> priority = fields_.Integers(node, "priorityLevel", {0});
    fields_.Require(priority.size() == 1 && priority[0] >= 0, node.line,
                    "priorityLevel is not an integer of 0 or more");
    if (priority[0] > options_.priority_level) return;
    const LightMap map{Color(node, "scaleRGB", 1), Color(node, "biasRGB", 0), subtracted,
                       node.line};
    const int surfaces = fields_.Child(node, "surfaceMapList", "LFM_SurfaceMapList");
    const int views = fields_.Child(node, "viewMapList", "LFM_ViewMapList");
    if (surfaces < 0) return;  // nothing is drawn
    if (views < 0) {
      fields_.Require(!subtracted, node.line,
                      "a texture without view maps is subtracted: a mean view cannot be negative");
      AddSurfaces(fields_.At(surfaces), 0, 0, content_.plain);
      content_.textures.resize(content_.plain.size(), map);
      return;
    }
    fields_.Require(map.scale.isConstant(map.scale[0], 0) && map.bias.isConstant(map.bias[0], 0) &&
                        map.scale[0] >= 0,
                    node.line,
                    "scaleRGB and biasRGB of view maps must be the same for red, green and blue, "
                    "and no scale below 0");
    const auto [first, count] = AddViews(views, map);
    AddSurfaces(fields_.At(surfaces), first, count, content_.surfaces);
  }

  // The entries of a list of view maps: the first one's index, and how many.
  Range AddViews(int list, const LightMap& map) {
    const std::pair key(list, coordinate_);
    if (const auto known = view_lists_.find(key); known != view_lists_.end()) {
      const LightMap& other = content_.light_maps[known->second.light_map];
      fields_.Require(
          other.scale == map.scale && other.bias == map.bias && other.subtracted == map.subtracted,
          map.line, "one list of view maps is used with different ranges");
      return known->second.entries;
    }
    const Node& node = fields_.At(list);
    ReadDirectionMap(node);
    const std::vector<int> vertices = fields_.Integers(node, "vertexIndex");
    const std::vector<int> tiles = fields_.Integers(node, "tileIndex");
    const std::vector<Eigen::Vector2f> origins = Coordinates(node, "textureOrigin");
    const std::vector<Eigen::Vector2f> sizes = Coordinates(node, "textureSize");
    fields_.Require(tiles.size() == vertices.size() && origins.size() == vertices.size() &&
                        sizes.size() == vertices.size(),
                    node.line, "the lists of a list of view maps differ in length");
    const auto first = static_cast<int>(content_.views.size());
    terms_.resize(content_.mesh.vertices.size(), 0);
    for (size_t i = 0; i < vertices.size(); ++i) {
      fields_.Require(vertices[i] >= 0 && vertices[i] < vertex_count_, node.line,
                      "a view map names a vertex that is not there");
      const int vertex = first_vertex_ + vertices[i];
      fields_.Require(terms_[vertex] < glb::kMaxTerms, node.line,
                      "a vertex has more than 16 view maps");
      content_.views.push_back({vertex, terms_[vertex]++, Tile(tiles[i], node.line), origins[i],
                                sizes[i], static_cast<int>(content_.light_maps.size()), node.line});
    }
    const auto light_map = static_cast<int>(content_.light_maps.size());
    content_.light_maps.push_back(map);
    const Range entries{first, static_cast<int>(vertices.size())};
    view_lists_[key] = {entries, light_map};
    return entries;
  }

  void ReadDirectionMap(const Node& node) {
    const std::string name = fields_.String(node, "directionMap", "orthographic");
    const auto* known =
        std::find(std::begin(glb::kDirectionMapNames), std::end(glb::kDirectionMapNames), name);
    fields_.Require(known != std::end(glb::kDirectionMapNames), node.line,
                    "directionMap " + vrml::Quoted(name) + " is not known");
    const auto map = static_cast<DirectionMap>(known - std::begin(glb::kDirectionMapNames));
    fields_.Require(content_.views.empty() || content_.direction_map == map, node.line,
                    "view maps differ in their directionMap");
    content_.direction_map = map;
  }

  std::vector<Eigen::Vector2f> Coordinates(const Node& node, const char* field) const {
    const int child = fields_.Child(node, field, "TextureCoordinate");
    std::vector<Eigen::Vector2f> points;
    if (child < 0) return points;
    const std::vector<float> values = fields_.Floats(fields_.At(child), "point", 2);
    for (size_t i = 0; i < values.size(); i += 2) points.emplace_back(values[i], values[i + 1]);
    return points;
  }

  int Tile(int index, int line) const {
    fields_.Require(index >= 0 && static_cast<size_t>(index) < shape_tiles_.size(), line,
                    "a map names a tile that is not there");
    return shape_tiles_[index];
  }

  // `views` view entries from `first_view` on; none: plain textures.
  void AddSurfaces(const Node& node, int first_view, int views,
                   std::vector<SurfaceEntry>& entries) {
    const bool plain = &entries == &content_.plain;
    const std::vector<int> triangles = fields_.Integers(node, "triangleIndex");
    const std::vector<int> tiles = fields_.Integers(node, "tileIndex");
    const std::vector<int> view_maps = fields_.Integers(node, "viewMapIndex");
    const std::vector<Eigen::Vector2f> corners = Coordinates(node, "triangleCoordinate");
    fields_.Require(tiles.size() == triangles.size() &&
                        (view_maps.size() == triangles.size() || (plain && view_maps.empty())) &&
                        corners.size() == 3 * triangles.size(),
                    node.line, "the lists of a list of surface maps differ in length");
    const size_t most = content_.mesh.triangles.size() * (plain ? 1 : 3 * glb::kMaxTerms);
    fields_.Require(entries.size() + triangles.size() <= most, node.line,
                    plain ? "a triangle has two plain textures"
                          : "a triangle has more surface maps than its vertices can have");
    for (size_t i = 0; i < triangles.size(); ++i) {
      fields_.Require(triangles[i] >= 0 && triangles[i] < triangle_count_, node.line,
                      "a surface map names a triangle that is not there");
      const int view = plain && view_maps.empty() ? -1 : view_maps[i];
      fields_.Require(plain ? view == -1 : view >= 0 && view < views, node.line,
                      plain ? "viewMapIndex must be -1 where there are no view maps"
                            : "a surface map names a view map that is not there");
      entries.push_back({first_triangle_ + triangles[i],
                         Tile(tiles[i], node.line),
                         plain ? -1 : first_view + view,
                         {corners[3 * i], corners[3 * i + 1], corners[3 * i + 2]},
                         node.line});
    }
  }

  struct ViewList {
    Range entries;
    int light_map = 0;
  };

  const vrml::Scene& scene_;
  vrml::Fields fields_;
  AfxReadOptions options_;
  Content content_;
  std::set<int> used_;             // face sets and appearances
  std::map<int, Range> vertices_;  // by Coordinate node
  std::set<std::pair<int, int>> frame_lists_;
  std::map<std::string, int> tile_numbers_;
  std::map<std::pair<int, int>, ViewList> view_lists_;  // by list and Coordinate node
  std::vector<int> terms_;                              // of each vertex so far
  // Of the shape that is being read.
  int coordinate_ = -1, first_vertex_ = 0, vertex_count_ = 0, first_triangle_ = 0,
      triangle_count_ = 0;
  std::vector<int> shape_tiles_;
};

}  // namespace

Content CollectContent(const vrml::Scene& scene, const std::string& name,
                       const AfxReadOptions& options) {
  return Collector(scene, name, options).Collect();
}

}  // namespace lfm::afx
