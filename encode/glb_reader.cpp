// SPDX-License-Identifier: BSD-3-Clause
// Trusts nothing: every index, count and offset is checked before it is used, and sizes of pictures
// are read from their headers before anything is decoded.
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <optional>

#include "core/atomic_file.h"
#include "core/error.h"
#include "core/parallel.h"
#include "encode/file_errors.h"
#include "encode/glb.h"
#include "encode/glb_container.h"
#include "encode/glb_document.h"
#include "encode/glb_format.h"
#include "encode/glb_places.h"
#include "encode/guessed_directions.h"
#include "encode/png_header.h"

namespace lfm {
namespace {

using glb::Accessor;
using glb::BufferView;
using glb::Document;
using glb::Element;
using glb::Floats;
using glb::Integer;
using glb::kAnyIndex;
using glb::Member;
using nlohmann::json;

constexpr int64_t kMaxTexels = int64_t{1} << 28;  // of all pages together: 0.8 GB
constexpr float kMaxRange = 1e6f;                 // of a map's values; products stay finite

void ReadMesh(const Document& doc, const json& extension, LightFieldModel& model) {
  const auto vertices = Floats(doc, extension, "vertices", GltfShape::kVec3, -1);
  const auto count = static_cast<int64_t>(vertices.size() / 3);
  for (int64_t v = 0; v < count; ++v) {
    model.mesh.vertices.emplace_back(vertices[3 * v], vertices[3 * v + 1], vertices[3 * v + 2]);
  }
  const auto corners = Accessor<uint32_t>(doc, extension, "triangles", GltfComponent::kUint32,
                                          GltfShape::kScalar, -1);
  doc.Require(corners.size() % 3 == 0, "accessor \"triangles\" has another length");
  for (size_t c = 0; c < corners.size(); c += 3) {
    for (size_t e = c; e < c + 3; ++e) {
      doc.Require(corners[e] < vertices.size() / 3, "a triangle names a vertex that is not there");
    }
    model.mesh.triangles.emplace_back(corners[c], corners[c + 1], corners[c + 2]);
  }
}

void ReadFrames(const Document& doc, const json& extension, LightFieldModel& model) {
  const auto count = static_cast<int64_t>(model.mesh.vertices.size());
  const auto frames = Floats(doc, extension, "frames", GltfShape::kVec4, count);
  for (int64_t v = 0; v < count; ++v) {
    const float* q = frames.data() + 4 * v;
    const Eigen::Quaterniond rotation(q[3], q[0], q[1], q[2]);
    doc.Require(std::abs(rotation.norm() - 1) < 1e-3, "a vertex frame is not a unit quaternion");
    model.vertex_frames.push_back(rotation.normalized().toRotationMatrix());
    model.mesh.normals.push_back(model.vertex_frames.back().col(2));
  }
}

std::vector<MapRange> ReadRanges(const Document& doc, const json& extension, const char* key,
                                 int64_t count) {
  std::vector<MapRange> ranges;
  const auto values = Floats(doc, extension, key, GltfShape::kVec2, count);
  for (size_t i = 0; i < values.size(); i += 2) {
    doc.Require(values[i] >= 0 && values[i] <= kMaxRange && std::abs(values[i + 1]) <= kMaxRange,
                "the range of a map is negative or too large");
    ranges.push_back({values[i], values[i + 1]});
  }
  return ranges;
}

void ReadTerms(const Document& doc, const json& extension, LightFieldModel& model) {
  const auto vertices = static_cast<int64_t>(model.mesh.vertices.size());
  model.terms = static_cast<int>(Integer(doc, extension, "terms", 0, glb::kMaxTerms));
  if (extension.contains("meanInTerms")) {
    doc.Require(extension["meanInTerms"].is_boolean(), "\"meanInTerms\" is not true or false");
    model.mean_in_terms = extension["meanInTerms"].get<bool>();
  }
  const auto terms = Accessor<uint8_t>(doc, extension, "vertexTerms", GltfComponent::kUint8,
                                       GltfShape::kScalar, vertices);
  for (const uint8_t count : terms) {
    doc.Require(count <= model.terms, "a vertex has more terms than the model");
    model.vertex_terms.push_back(count);
  }
  model.view_slots = RankByTerms(model.vertex_terms);
  if (model.terms == 0) return;
  model.surface_ranges = ReadRanges(doc, extension, "surfaceRanges", model.terms * vertices);
  model.view_ranges = ReadRanges(doc, extension, "viewRanges", model.terms * vertices);
}

// A page that is known to be a small enough RGB picture, not yet decoded.
struct PendingPage {
  std::string_view png;
  Eigen::Vector2i size = {0, 0};
};

PendingPage FindPage(const Document& doc, const json& index) {
  doc.Require(index.is_number_unsigned() && index.get<uint64_t>() <= uint64_t{kAnyIndex},
              "an image index is not a small integer");
  const json& image = Element(doc, "images", index.get<int64_t>());
  PendingPage page{BufferView(doc, image)};
  const std::optional<PngHeader> header = ReadPngHeader(page.png);
  doc.Require(header.has_value(), "an image is not a PNG");
  doc.Require(header->bit_depth == 8 && header->channels == 3, "an image is not 8-bit RGB");
  doc.Require(std::min(header->width, header->height) >= 1 &&
                  std::max(header->width, header->height) <= glb::kMaxTextureSize,
              "an image is larger than 16384 texels a side");
  page.size = {static_cast<int>(header->width), static_cast<int>(header->height)};
  return page;
}

std::vector<PendingPage> FindPages(const Document& doc, const json& indices) {
  doc.Require(indices.is_array(), "a list of images is not an array");
  std::vector<PendingPage> pages;
  for (const json& index : indices) pages.push_back(FindPage(doc, index));
  return pages;
}

struct PendingPages {
  std::vector<PendingPage> mean;
  std::vector<std::vector<PendingPage>> surface, view;
};

PendingPages FindAllPages(const Document& doc, const json& extension, int terms) {
  PendingPages pages;
  if (extension.contains("blocks")) return pages;  // pictures there are for others
  pages.mean = FindPages(doc, Member(doc, extension, "meanImages"));
  const auto lists = [&](const char* key) {
    const json& list = Member(doc, extension, key);
    doc.Require(list.is_array() && static_cast<int>(list.size()) == terms,
                std::string("\"") + key + "\" does not have one list a term");
    std::vector<std::vector<PendingPage>> result;
    for (const json& indices : list) result.push_back(FindPages(doc, indices));
    return result;
  };
  pages.surface = lists("surfaceImages");
  pages.view = lists("viewImages");
  return pages;
}

void CheckTexels(const Document& doc, const PendingPages& pages) {
  int64_t texels = 0;
  const auto count = [&](const std::vector<PendingPage>& list) {
    for (const PendingPage& page : list) texels += int64_t{page.size.x()} * page.size.y();
    doc.Require(texels <= kMaxTexels, "the pages hold more texels than a model may have");
  };
  count(pages.mean);
  for (const auto& list : pages.surface) count(list);
  for (const auto& list : pages.view) count(list);
}

void ReadViewLayout(const Document& doc, const json& extension, LightFieldModel& model) {
  model.grid = static_cast<int>(Integer(doc, extension, "grid", 2, 256));
  const json& name = Member(doc, extension, "directionMap");
  const auto* known =
      std::find(std::begin(glb::kDirectionMapNames), std::end(glb::kDirectionMapNames), name);
  doc.Require(known != std::end(glb::kDirectionMapNames), "\"directionMap\" is not known");
  model.direction_map = static_cast<DirectionMap>(known - std::begin(glb::kDirectionMapNames));
  model.view_tiles_per_row =
      static_cast<int>(Integer(doc, extension, "viewTilesPerRow", 1, glb::kMaxTextureSize));
  model.view_tiles_per_page =
      static_cast<int>(Integer(doc, extension, "viewTilesPerPage", 1, kAnyIndex));
}

void ReadGuessedDirections(const Document& doc, const json& extension, LightFieldModel& model) {
  if (!extension.contains("guessedDirections")) return;
  const size_t bytes = GuessedBytes(model.grid) * model.mesh.vertices.size();
  model.guessed = Accessor<uint8_t>(doc, extension, "guessedDirections", GltfComponent::kUint8,
                                    GltfShape::kScalar, static_cast<int64_t>(bytes));
}

void DecodePages(const Document& doc, const PendingPages& pending, LightFieldModel& model) {
  struct Job {
    const PendingPage* from;
    Image* to;
  };
  std::vector<Job> jobs;
  const auto plan = [&jobs](const std::vector<PendingPage>& from, std::vector<Image>& to) {
    to.resize(from.size());
    for (size_t i = 0; i < from.size(); ++i) jobs.push_back({&from[i], &to[i]});
  };
  model.surface_pages.resize(model.terms);
  model.view_pages.resize(model.terms);
  plan(pending.mean, model.mean_pages);
  for (int k = 0; k < model.terms; ++k) {
    plan(pending.surface[k], model.surface_pages[k]);
    plan(pending.view[k], model.view_pages[k]);
  }
  ParallelFor(0, static_cast<int64_t>(jobs.size()), [&](int64_t i) {
    const Job& job = jobs[i];
    *job.to = DecodeImage(reinterpret_cast<const std::byte*>(job.from->png.data()),
                          job.from->png.size(), doc.file);
    doc.Require(job.to->width() == job.from->size.x() && job.to->height() == job.from->size.y() &&
                    job.to->channels() == 3 && job.to->type() == PixelType::kUint8,
                "an image differs from its header");
  });
}

void DropTerms(LightFieldModel& model) {
  model.terms = 0;
  model.mean_in_terms = false;
  model.vertex_terms.assign(model.vertex_terms.size(), 0);
  model.view_slots = RankByTerms(model.vertex_terms);
  model.surface_ranges.clear();
  model.view_ranges.clear();
  model.surface_placements.clear();
  model.view_codes.clear();
  model.view_tile_counts.clear();
  model.blocks.surface.clear();
  model.blocks.view.clear();
}

LightFieldModel ReadDocument(const Document& doc, GlbContent content) {
  const json& root = doc.container.json;
  doc.Require(root.is_object() && root.contains("extensions") && root["extensions"].is_object() &&
                  root["extensions"].contains(glb::kExtension),
              std::string("no extension ") + glb::kExtension + ": not a light field model");
  doc.Require(!root.contains("extensionsRequired"), "it requires extensions that are not known");
  const json& extension = root["extensions"][glb::kExtension];
  Integer(doc, extension, "version", glb::kOldestVersion, glb::kVersion);
  LightFieldModel model;
  ReadMesh(doc, extension, model);
  ReadFrames(doc, extension, model);
  ReadTerms(doc, extension, model);
  const PendingPages pages = FindAllPages(doc, extension, model.terms);
  CheckTexels(doc, pages);
  glb::ReadPlaces(doc, extension, model);
  ReadViewLayout(doc, extension, model);
  ReadGuessedDirections(doc, extension, model);
  const bool in_blocks = extension.contains("blocks");
  if (in_blocks) glb::ReadBlocks(doc, extension["blocks"], kMaxTexels, model);
  if (content == GlbContent::kMeanView) DropTerms(model);
  if (in_blocks) {
    glb::DecodeBlocks(model);
  } else {
    DecodePages(doc, pages, model);
  }
  ValidateModel(model, doc.file);
  return model;
}

}  // namespace

LightFieldModel ReadGlb(const std::filesystem::path& file, GlbContent content) {
  return ReadGlbBytes(ReadFile(file), file.string(), content);
}

LightFieldModel ReadGlbBytes(std::string_view bytes, const std::string& name, GlbContent content) {
  return NamingFile(name, [&] {
    const GlbContainer container = ParseGlb(bytes, name);
    return ReadDocument({container, name}, content);
  });
}

}  // namespace lfm
