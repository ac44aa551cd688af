// SPDX-License-Identifier: BSD-3-Clause
#include "encode/glb.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "core/atomic_file.h"
#include "core/error.h"
#include "core/parallel.h"
#include "encode/glb_container.h"
#include "encode/glb_format.h"

namespace lfm {
namespace {

using nlohmann::json;

constexpr int kVertexTarget = 34962, kIndexTarget = 34963;
constexpr int kLinear = 9729, kClampToEdge = 33071;

// Texture coordinates of a patch corner: the texel's centre.
Eigen::Vector2f CornerTexcoord(const PatchPlacement& placement, const Image& page, int corner) {
  const int last = (placement.flipped ? -1 : 1) * (placement.edge_samples - 1);
  const float x = placement.origin.x() + (corner == 1 ? last : 0) + 0.5f;
  const float y = placement.origin.y() + (corner == 2 ? last : 0) + 0.5f;
  return {x / static_cast<float>(page.width()), y / static_cast<float>(page.height())};
}

// The plain mesh that any glTF viewer shows: three vertices a triangle, one primitive a page.
void AddPlainMesh(const LightFieldModel& model, GlbBuilder& builder) {
  std::vector<float> positions, texcoords;
  Eigen::Vector3f low = Eigen::Vector3f::Constant(HUGE_VALF), high = -low;
  std::vector<std::vector<uint32_t>> indices(model.mean_pages.size());
  for (size_t t = 0; t < model.placements.size(); ++t) {
    const PatchPlacement& placement = model.placements[t];
    for (int c = 0; c < 3; ++c) {
      const Eigen::Vector3f p = model.mesh.vertices[model.mesh.triangles[t][c]].cast<float>();
      const Eigen::Vector2f uv = CornerTexcoord(placement, model.mean_pages[placement.page], c);
      positions.insert(positions.end(), p.data(), p.data() + 3);
      texcoords.insert(texcoords.end(), uv.data(), uv.data() + 2);
      low = low.cwiseMin(p);
      high = high.cwiseMax(p);
      indices[placement.page].push_back(static_cast<uint32_t>(3 * t + c));
    }
  }
  const int position =
      builder.AddAccessor(positions, GltfComponent::kFloat32, GltfShape::kVec3, kVertexTarget);
  builder.accessor(position)["min"] = {low[0], low[1], low[2]};
  builder.accessor(position)["max"] = {high[0], high[1], high[2]};
  const int texcoord =
      builder.AddAccessor(texcoords, GltfComponent::kFloat32, GltfShape::kVec2, kVertexTarget);
  json primitives = json::array();
  for (size_t page = 0; page < indices.size(); ++page) {
    const int accessor = builder.AddAccessor(indices[page], GltfComponent::kUint32,
                                             GltfShape::kScalar, kIndexTarget);
    primitives.push_back({{"attributes", {{"POSITION", position}, {"TEXCOORD_0", texcoord}}},
                          {"indices", accessor},
                          {"material", page}});
  }
  builder.json["meshes"] = json::array({{{"name", "mean view"}, {"primitives", primitives}}});
}

void AddMaterials(const std::vector<int>& mean_images, json& document) {
  document["samplers"] = json::array({{{"magFilter", kLinear},
                                       {"minFilter", kLinear},
                                       {"wrapS", kClampToEdge},
                                       {"wrapT", kClampToEdge}}});
  for (size_t page = 0; page < mean_images.size(); ++page) {
    document["textures"].push_back({{"sampler", 0}, {"source", mean_images[page]}});
    document["materials"].push_back(
        {{"name", "mean view " + std::to_string(page)},
         {"pbrMetallicRoughness",
          {{"baseColorTexture", {{"index", page}}}, {"metallicFactor", 0}, {"roughnessFactor", 1}}},
         {"extensions", {{"KHR_materials_unlit", json::object()}}}});
  }
}

// Millimetres to metres; world z up to glTF's y up: a turn by -90 degrees about x.
void AddScene(json& document) {
  const double half = std::sqrt(0.5);
  document["nodes"] = json::array({{{"name", "millimetres, z up"},
                                    {"mesh", 0},
                                    {"rotation", {-half, 0, 0, half}},
                                    {"scale", {0.001, 0.001, 0.001}}}});
  document["scenes"] = json::array({{{"nodes", {0}}}});
  document["scene"] = 0;
}

// Every page as PNG bytes; the slow part, so in parallel.
std::vector<std::vector<std::byte>> EncodePages(const std::vector<const Image*>& pages) {
  std::vector<std::vector<std::byte>> bytes(pages.size());
  ParallelFor(0, static_cast<int64_t>(pages.size()),
              [&](int64_t i) { bytes[i] = EncodePng(*pages[i], glb::kPngCompression); });
  return bytes;
}

struct ImageIndices {
  std::vector<int> mean;
  std::vector<std::vector<int>> surface, view;
};

// All pages as PNG, added in the order in which they are shown: the mean view, then what else is
// needed to show terms, then the terms one after the other. So a reader can show what has arrived.
class ImageWriter {
 public:
  // Pages in blocks keep the mean view as pictures too: other viewers show it.
  explicit ImageWriter(const LightFieldModel& model)
      : model_(model), terms_(model.blocks.empty() ? model.terms : 0) {
    std::vector<const Image*> pages;
    const auto collect = [&](const std::vector<Image>& images, const std::string& what) {
      for (size_t page = 0; page < images.size(); ++page) {
        pages.push_back(&images[page]);
        names_.push_back(what + ", page " + std::to_string(page));
      }
    };
    collect(model.mean_pages, "mean view");
    for (int k = 0; k < terms_; ++k) {
      collect(model.surface_pages[k], "surface maps, term " + std::to_string(k + 1));
      collect(model.view_pages[k], "view maps, term " + std::to_string(k + 1));
    }
    bytes_ = EncodePages(pages);
  }

  void AddMean(GlbBuilder& builder) { indices_.mean = Add(model_.mean_pages.size(), builder); }
  void AddTerms(GlbBuilder& builder) {
    for (int k = 0; k < terms_; ++k) {
      indices_.surface.push_back(Add(model_.surface_pages[k].size(), builder));
      indices_.view.push_back(Add(model_.view_pages[k].size(), builder));
    }
  }
  const ImageIndices& indices() const { return indices_; }

 private:
  std::vector<int> Add(size_t count, GlbBuilder& builder) {
    std::vector<int> indices;
    for (size_t i = 0; i < count; ++i, ++next_) {
      indices.push_back(builder.AddPng(bytes_[next_], names_[next_]));
    }
    return indices;
  }

  const LightFieldModel& model_;
  int terms_;
  std::vector<std::vector<std::byte>> bytes_;
  std::vector<std::string> names_;
  size_t next_ = 0;
  ImageIndices indices_;
};

std::vector<float> FrameQuaternions(const LightFieldModel& model) {
  std::vector<float> values;
  for (const Eigen::Matrix3d& frame : model.vertex_frames) {
    Eigen::Quaterniond q(frame);
    if (q.w() < 0) q.coeffs() = -q.coeffs();
    for (const double value : {q.x(), q.y(), q.z(), q.w()}) {
      values.push_back(static_cast<float>(value));
    }
  }
  return values;
}

std::vector<uint16_t> PackedPlacements(const std::vector<PatchPlacement>& placements) {
  std::vector<uint16_t> values;
  for (const PatchPlacement& p : placements) {
    const int size = 2 * p.edge_samples + (p.flipped ? 1 : 0);
    for (const int value : {p.page, p.origin.x(), p.origin.y(), size}) {
      values.push_back(static_cast<uint16_t>(value));
    }
  }
  return values;
}

std::vector<float> PackedRanges(const std::vector<MapRange>& ranges) {
  std::vector<float> values;
  for (const MapRange& range : ranges) values.insert(values.end(), {range.scale, range.bias});
  return values;
}

json ExtensionGeometry(const LightFieldModel& model, GlbBuilder& builder) {
  std::vector<float> vertices;
  for (const Eigen::Vector3d& p : model.mesh.vertices) {
    for (const double value : p) vertices.push_back(static_cast<float>(value));
  }
  std::vector<uint32_t> triangles;
  for (const Eigen::Vector3i& t : model.mesh.triangles) {
    for (const int vertex : t) triangles.push_back(static_cast<uint32_t>(vertex));
  }
  const std::vector<uint8_t> terms(model.vertex_terms.begin(), model.vertex_terms.end());
  return {{"vertices", builder.AddAccessor(vertices, GltfComponent::kFloat32, GltfShape::kVec3)},
          {"triangles", builder.AddAccessor(triangles, GltfComponent::kUint32, GltfShape::kScalar)},
          {"frames",
           builder.AddAccessor(FrameQuaternions(model), GltfComponent::kFloat32, GltfShape::kVec4)},
          {"vertexTerms", builder.AddAccessor(terms, GltfComponent::kUint8, GltfShape::kScalar)}};
}

int AddPlacements(const std::vector<PatchPlacement>& placements, GlbBuilder& builder) {
  return builder.AddAccessor(PackedPlacements(placements), GltfComponent::kUint16,
                             GltfShape::kVec4);
}

int AddIndices(const std::vector<uint32_t>& indices, size_t codes, GlbBuilder& builder) {
  if (codes > 1 << 16) {
    return builder.AddAccessor(indices, GltfComponent::kUint32, GltfShape::kScalar);
  }
  const std::vector<uint16_t> shorter(indices.begin(), indices.end());
  return builder.AddAccessor(shorter, GltfComponent::kUint16, GltfShape::kScalar);
}

json PatchCodebook(const std::vector<PatchPlacement>& placements, GlbBuilder& builder) {
  const SharedPlacements shared = FindSharedPlacements(placements);
  return {{"placements", AddPlacements(shared.codes, builder)},
          {"indices", AddIndices(shared.indices, shared.codes.size(), builder)}};
}

// Where patches and tiles lie: one placement a triangle, or codebooks.
void AddPlaces(const LightFieldModel& model, json& extension, GlbBuilder& builder) {
  const bool shared = !model.surface_placements.empty() ||
                      (model.terms == 0 && FindSharedPlacements(model.placements).codes.size() <
                                               model.placements.size());
  if (!shared) {
    extension["placements"] = AddPlacements(model.placements, builder);
    return;
  }
  extension["meanCodebook"] = PatchCodebook(model.placements, builder);
  if (model.terms == 0) return;
  json& patches = extension["surfaceCodebooks"];
  for (int k = 0; k < static_cast<int>(model.surface_placements.size()); ++k) {
    const int first = FirstEqual(model.surface_placements, k);
    const json entry =
        first < k ? patches[first] : PatchCodebook(model.surface_placements[k], builder);
    patches.push_back(entry);
  }
  json& views = extension["viewIndices"];
  for (int k = 0; k < static_cast<int>(model.view_codes.size()); ++k) {
    const std::vector<uint32_t> indices(model.view_codes[k].begin(), model.view_codes[k].end());
    const size_t most = size_t{1} + *std::max_element(indices.begin(), indices.end());
    const int first = FirstEqual(model.view_codes, k);
    const json entry = first < k ? views[first] : json(AddIndices(indices, most, builder));
    views.push_back(entry);
  }
  if (!model.view_tile_counts.empty()) extension["viewTileCounts"] = model.view_tile_counts;
}

json BlockPages(const std::vector<BlockPage>& pages, GlbBuilder& builder) {
  json list = json::array();
  for (const BlockPage& page : pages) {
    list.push_back({{"bufferView", builder.AddView(page.blocks.data(), page.blocks.size())},
                    {"width", page.width},
                    {"height", page.height}});
  }
  return list;
}

// Mean pages before the tables, which are needed to show terms; terms behind them.
json AddMeanBlocks(const LightFieldModel& model, GlbBuilder& builder) {
  return {{"surfaceFormat", model.SurfacePlanes() == 1 ? glb::kOnePlane : glb::kThreePlanes},
          {"mean", BlockPages(model.blocks.mean, builder)}};
}

void AddTermBlocks(const LightFieldModel& model, json& blocks, GlbBuilder& builder) {
  blocks["surface"] = blocks["view"] = json::array();
  for (int k = 0; k < model.terms; ++k) {
    blocks["surface"].push_back(BlockPages(model.blocks.surface[k], builder));
    blocks["view"].push_back(BlockPages(model.blocks.view[k], builder));
  }
}

json ExtensionTables(const LightFieldModel& model, GlbBuilder& builder) {
  json extension = ExtensionGeometry(model, builder);
  AddPlaces(model, extension, builder);
  const bool whole_views = model.view_tile_counts.empty();
  extension["version"] = whole_views ? glb::kVersionOfWholeViews : glb::kVersion;
  extension["terms"] = model.terms;
  if (model.mean_in_terms) extension["meanInTerms"] = true;
  extension["grid"] = model.grid;
  extension["directionMap"] = glb::kDirectionMapNames[static_cast<int>(model.direction_map)];
  extension["viewTilesPerRow"] = model.view_tiles_per_row;
  extension["viewTilesPerPage"] = model.view_tiles_per_page;
  if (model.terms > 0) {
    extension["surfaceRanges"] = builder.AddAccessor(PackedRanges(model.surface_ranges),
                                                     GltfComponent::kFloat32, GltfShape::kVec2);
    extension["viewRanges"] = builder.AddAccessor(PackedRanges(model.view_ranges),
                                                  GltfComponent::kFloat32, GltfShape::kVec2);
  }
  return extension;
}

void AddExtension(const LightFieldModel& model, ImageWriter& images, GlbBuilder& builder) {
  json blocks;
  if (!model.blocks.empty()) blocks = AddMeanBlocks(model, builder);
  json extension = ExtensionTables(model, builder);
  images.AddTerms(builder);
  extension["meanImages"] = images.indices().mean;
  if (model.blocks.empty()) {
    extension["surfaceImages"] = images.indices().surface;
    extension["viewImages"] = images.indices().view;
  } else {
    AddTermBlocks(model, blocks, builder);
    extension["blocks"] = blocks;
  }
  if (!model.guessed.empty()) {
    extension["guessedDirections"] =
        builder.AddAccessor(model.guessed, GltfComponent::kUint8, GltfShape::kScalar);
  }
  builder.json["extensions"][glb::kExtension] = extension;
  builder.json["extensionsUsed"] = {"KHR_materials_unlit", glb::kExtension};
}

}  // namespace

std::string GlbBytes(const LightFieldModel& model) {
  GlbBuilder builder;
  builder.json["asset"] = {{"version", "2.0"}, {"generator", "lfm " LFM_VERSION}};
  AddPlainMesh(model, builder);
  ImageWriter images(model);
  images.AddMean(builder);
  AddMaterials(images.indices().mean, builder.json);
  AddScene(builder.json);
  AddExtension(model, images, builder);
  return BuildGlb(builder.Finish());
}

int64_t WriteGlb(const LightFieldModel& model, const std::filesystem::path& file) {
  const std::string bytes = GlbBytes(model);
  WriteFileAtomically(file, bytes);
  return static_cast<int64_t>(bytes.size());
}

}  // namespace lfm
