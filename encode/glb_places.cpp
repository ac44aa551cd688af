// SPDX-License-Identifier: BSD-3-Clause
#include "encode/glb_places.h"

#include "encode/glb_format.h"

namespace lfm::glb {
namespace {

using nlohmann::json;

std::vector<PatchPlacement> Placements(const Document& doc, const json& owner, int64_t count) {
  const auto values =
      Accessor<uint16_t>(doc, owner, "placements", GltfComponent::kUint16, GltfShape::kVec4, count);
  std::vector<PatchPlacement> placements;
  for (size_t i = 0; i < values.size(); i += 4) {
    const uint16_t* v = values.data() + i;
    placements.push_back({v[0], {v[1], v[2]}, (v[3] & 1) != 0, v[3] / 2});
  }
  return placements;
}

// `count` indices into `codes` codes (-1: any number), of 16 or 32 bits.
std::vector<int> Indices(const Document& doc, const json& owner, const char* key, int64_t count,
                         int64_t codes) {
  const json& accessor = Element(doc, "accessors", Integer(doc, owner, key, 0, kAnyIndex));
  const int64_t component = Integer(doc, accessor, "componentType", 0, 65535);
  std::vector<int> indices;
  const auto add = [&](const auto& values) {
    for (const int64_t value : values) {
      doc.Require(value <= kAnyIndex && (codes < 0 || value < codes),
                  "an index into a codebook is out of range");
      indices.push_back(static_cast<int>(value));
    }
  };
  if (component == static_cast<int>(GltfComponent::kUint16)) {
    add(Accessor<uint16_t>(doc, owner, key, GltfComponent::kUint16, GltfShape::kScalar, count));
  } else {
    add(Accessor<uint32_t>(doc, owner, key, GltfComponent::kUint32, GltfShape::kScalar, count));
  }
  return indices;
}

std::vector<PatchPlacement> Codebook(const Document& doc, const json& codebook, int64_t count) {
  const std::vector<PatchPlacement> codes = Placements(doc, codebook, -1);
  std::vector<PatchPlacement> placements;
  for (const int index :
       Indices(doc, codebook, "indices", count, static_cast<int64_t>(codes.size()))) {
    placements.push_back(codes[index]);
  }
  return placements;
}

const json& ListOfTerms(const Document& doc, const json& owner, const char* key, int terms) {
  const json& list = Member(doc, owner, key);
  doc.Require(list.is_array() && static_cast<int>(list.size()) == terms,
              std::string("\"") + key + "\" does not have one entry a term");
  return list;
}

class BlockReader {
 public:
  BlockReader(const Document& doc, int64_t max_texels) : doc_(doc), left_(max_texels) {}
  std::vector<BlockPage> Pages(const json& list, int planes) {
    doc_.Require(list.is_array(), "a list of pages in blocks is not an array");
    std::vector<BlockPage> pages;
    for (const json& entry : list) {
      BlockPage page;
      page.width = static_cast<int>(Integer(doc_, entry, "width", 4, kMaxTextureSize));
      page.height = static_cast<int>(Integer(doc_, entry, "height", 4, kMaxTextureSize));
      page.planes = planes;
      const int64_t texels = int64_t{page.width} * page.height;
      left_ -= texels;
      doc_.Require(left_ >= 0, "the pages hold more texels than a model may have");
      const std::string_view bytes = BufferView(doc_, entry);
      doc_.Require(page.width % 4 == 0 && page.height % 4 == 0 &&
                       static_cast<int64_t>(bytes.size()) == planes * texels / 2,
                   "the blocks of a page do not fill it");
      page.blocks.assign(bytes.begin(), bytes.end());
      pages.push_back(std::move(page));
    }
    return pages;
  }

 private:
  const Document& doc_;
  int64_t left_;
};

std::vector<Image> Decoded(const std::vector<BlockPage>& blocks) {
  std::vector<Image> pages;
  for (const BlockPage& page : blocks) pages.push_back(DecodePage(page));
  return pages;
}

}  // namespace

void ReadPlaces(const Document& doc, const json& extension, LightFieldModel& model) {
  const auto triangles = static_cast<int64_t>(model.mesh.triangles.size());
  const auto vertices = static_cast<int64_t>(model.mesh.vertices.size());
  if (!extension.contains("meanCodebook")) {
    model.placements = Placements(doc, extension, triangles);
    return;
  }
  model.placements = Codebook(doc, extension["meanCodebook"], triangles);
  if (model.terms == 0) return;
  for (const json& codebook : ListOfTerms(doc, extension, "surfaceCodebooks", model.terms)) {
    model.surface_placements.push_back(Codebook(doc, codebook, triangles));
  }
  const json& views = ListOfTerms(doc, extension, "viewIndices", model.terms);
  for (const json& index : views) {
    model.view_codes.push_back(Indices(doc, json{{"indices", index}}, "indices", vertices, -1));
  }
  if (!extension.contains("viewTileCounts")) return;
  for (const json& counts : ListOfTerms(doc, extension, "viewTileCounts", model.terms)) {
    ViewTileCounts& own = model.view_tile_counts.emplace_back();
    doc.Require(counts.is_array() && counts.size() == own.size(),
                "an entry of \"viewTileCounts\" is not a list of three");
    for (size_t level = 0; level < own.size(); ++level) {
      const json& count = counts[level];
      doc.Require(count.is_number_unsigned() && count.get<uint64_t>() <= uint64_t{kAnyIndex},
                  "an entry of \"viewTileCounts\" is out of range");
      own[level] = count.get<int>();
    }
  }
}

void ReadBlocks(const Document& doc, const json& blocks, int64_t max_texels,
                LightFieldModel& model) {
  const json& format = Member(doc, blocks, "surfaceFormat");
  doc.Require(format == kOnePlane || format == kThreePlanes,
              "\"surfaceFormat\" is neither bc1 nor bc4");
  BlockReader reader(doc, max_texels);
  model.blocks.mean = reader.Pages(Member(doc, blocks, "mean"), 1);
  doc.Require(!model.blocks.mean.empty(), "there are no mean pages");
  for (const json& pages : ListOfTerms(doc, blocks, "surface", model.terms)) {
    model.blocks.surface.push_back(reader.Pages(pages, format == kOnePlane ? 1 : 3));
  }
  for (const json& pages : ListOfTerms(doc, blocks, "view", model.terms)) {
    model.blocks.view.push_back(reader.Pages(pages, 1));
  }
}

void DecodeBlocks(LightFieldModel& model) {
  model.mean_pages = Decoded(model.blocks.mean);
  for (int k = 0; k < model.terms; ++k) {
    model.surface_pages.push_back(Decoded(model.blocks.surface[k]));
    model.view_pages.push_back(Decoded(model.blocks.view[k]));
  }
}

}  // namespace lfm::glb
