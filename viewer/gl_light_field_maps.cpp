// SPDX-License-Identifier: BSD-3-Clause
#include "viewer/gl_light_field_maps.h"

#include <epoxy/gl.h>

#include <algorithm>
#include <array>
#include <string>
#include <vector>

#include "core/error.h"

namespace lfm {
namespace {

GLint Limit(GLenum name) {
  GLint value = 0;
  glGetIntegerv(name, &value);
  return value;
}

void CheckLimits(const std::string& what, int width, int height, size_t layers) {
  const GLint max_size = Limit(GL_MAX_TEXTURE_SIZE);
  const GLint max_layers = Limit(GL_MAX_ARRAY_TEXTURE_LAYERS);
  if (width > max_size || height > max_size) {
    throw Error("the model's " + what + " pages are " + std::to_string(width) + "x" +
                std::to_string(height) + " texels and this graphics card takes " +
                std::to_string(max_size) + "; encode again with --max-texture-size " +
                std::to_string(max_size) + ", or use lfm-render --renderer cpu");
  }
  if (layers > static_cast<size_t>(max_layers)) {
    throw Error(
        "the model has " + std::to_string(layers) + " " + what +
        " pages and this graphics card takes " + std::to_string(max_layers) +
        "; encode again with a larger --max-texture-size, or use lfm-render --renderer cpu");
  }
}

/// Whether blocks go to the driver as they are.
bool ReadsBlocks(BlockUse block_use) {
  if (!epoxy_has_gl_extension("GL_EXT_texture_compression_s3tc")) return false;
  if (block_use != BlockUse::kAutomatic) return block_use == BlockUse::kAsTheyAre;
  const auto* name = reinterpret_cast<const char*>(glGetString(GL_RENDERER));
  const std::string renderer = name == nullptr ? "" : name;
  for (const char* software : {"llvmpipe", "softpipe", "SwiftShader", "Software Rasterizer"}) {
    if (renderer.find(software) != std::string::npos) return false;
  }
  return true;
}

/// An array of `layers` layers of RGB8, or of blocks; what is not uploaded is never read.
GlObject MakeArray(const std::string& what, GLenum format, int width, int height, size_t layers) {
  CheckLimits(what, width, height, layers);
  GlObject texture(GlObject::Kind::kTexture);
  glBindTexture(GL_TEXTURE_2D_ARRAY, texture.name());
  const auto depth = static_cast<GLsizei>(std::max<size_t>(layers, 1));
  if (format == GL_RGB8) {
    glTexImage3D(GL_TEXTURE_2D_ARRAY, 0, format, width, height, depth, 0, GL_RGB, GL_UNSIGNED_BYTE,
                 nullptr);
  } else {
    const GLsizei bytes = width / 2 * height * depth;
    const std::vector<uint8_t> zeros(bytes, 0);
    glCompressedTexImage3D(GL_TEXTURE_2D_ARRAY, 0, format, width, height, depth, 0, bytes,
                           zeros.data());
  }
  CheckGl("upload the " + what + " maps");
  glTexParameteri(GL_TEXTURE_2D_ARRAY, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
  glTexParameteri(GL_TEXTURE_2D_ARRAY, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
  glTexParameteri(GL_TEXTURE_2D_ARRAY, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
  glTexParameteri(GL_TEXTURE_2D_ARRAY, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
  return texture;
}

/// Pages of unequal size share the array of the largest one; coordinates are in texels, so the
/// unused rest is never read.
GlObject UploadPages(const std::string& what, const std::vector<const Image*>& pages) {
  int width = 1, height = 1;
  for (const Image* page : pages) {
    width = std::max(width, page->width());
    height = std::max(height, page->height());
  }
  GlObject texture = MakeArray(what, GL_RGB8, width, height, pages.size());
  glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
  for (size_t layer = 0; layer < pages.size(); ++layer) {
    glTexSubImage3D(GL_TEXTURE_2D_ARRAY, 0, 0, 0, static_cast<GLint>(layer), pages[layer]->width(),
                    pages[layer]->height(), 1, GL_RGB, GL_UNSIGNED_BYTE,
                    pages[layer]->Data<uint8_t>());
  }
  CheckGl("upload the " + what + " maps");
  return texture;
}

/// The same for pages in blocks, a layer a plane.
GlObject UploadBlocks(const std::string& what, const std::vector<const BlockPage*>& pages,
                      int planes) {
  const GLenum format = planes == 1 ? GL_COMPRESSED_RGB_S3TC_DXT1_EXT : GL_COMPRESSED_RED_RGTC1;
  int width = 4, height = 4;
  for (const BlockPage* page : pages) {
    width = std::max(width, page->width);
    height = std::max(height, page->height);
  }
  GlObject texture = MakeArray(what, format, width, height, pages.size() * planes);
  GLint layer = 0;
  for (const BlockPage* page : pages) {
    const size_t plane_bytes = page->blocks.size() / planes;
    for (int plane = 0; plane < planes; ++plane, ++layer) {
      glCompressedTexSubImage3D(GL_TEXTURE_2D_ARRAY, 0, 0, 0, layer, page->width, page->height, 1,
                                format, static_cast<GLsizei>(plane_bytes),
                                page->blocks.data() + plane * plane_bytes);
    }
  }
  CheckGl("upload the " + what + " maps");
  return texture;
}

using TableEntry = std::array<float, 4>;

GlObject UploadTable(const std::string& what, std::vector<TableEntry> entries) {
  constexpr size_t kWidth = GlLightFieldMaps::kTableWidth;
  const size_t rows = std::max<size_t>((entries.size() + kWidth - 1) / kWidth, 1);
  const auto max_size = static_cast<size_t>(Limit(GL_MAX_TEXTURE_SIZE));
  if (rows > max_size) {
    throw Error("the model has more vertices than this graphics card takes (" +
                std::to_string(max_size * kWidth) + " table entries for its " + what +
                "); use lfm-render --renderer cpu");
  }
  entries.resize(rows * kWidth, TableEntry{});
  GlObject texture(GlObject::Kind::kTexture);
  glBindTexture(GL_TEXTURE_2D, texture.name());
  glTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA32F, static_cast<GLsizei>(kWidth),
               static_cast<GLsizei>(rows), 0, GL_RGBA, GL_FLOAT, entries.data());
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
  CheckGl("upload the vertices' " + what);
  return texture;
}

/// `terms[k][page]` as one list, and where each term's pages begin in it.
template <typename Page>
std::vector<const Page*> ListPages(const std::vector<std::vector<Page>>& terms,
                                   std::array<int, GlLightFieldMaps::kMostTerms>& first) {
  std::vector<const Page*> pages;
  for (size_t k = 0; k < terms.size(); ++k) {
    first[k] = static_cast<int>(pages.size());
    for (const Page& page : terms[k]) pages.push_back(&page);
  }
  return pages;
}

template <typename Page>
std::vector<const Page*> ListPages(const std::vector<Page>& list) {
  std::vector<const Page*> pages;
  for (const Page& page : list) pages.push_back(&page);
  return pages;
}

std::vector<TableEntry> FrameEntries(const LightFieldModel& model) {
  std::vector<TableEntry> entries;
  entries.reserve(3 * model.vertex_frames.size());
  for (size_t v = 0; v < model.vertex_frames.size(); ++v) {
    const auto slot = static_cast<float>(model.view_slots[v]);  // exact below 2^24
    for (int axis = 0; axis < 3; ++axis) {
      const Eigen::Vector3f direction = model.vertex_frames[v].col(axis).cast<float>();
      const float fourth = axis == 0 ? slot : static_cast<float>(model.vertex_terms[v]);
      entries.push_back({direction.x(), direction.y(), direction.z(), fourth});
    }
  }
  return entries;
}

std::vector<TableEntry> RangeEntries(const LightFieldModel& model) {
  const size_t vertices = model.mesh.vertices.size();
  std::vector<TableEntry> entries(model.terms * vertices, TableEntry{});
  for (size_t v = 0; v < vertices; ++v) {
    const int terms = std::min(model.vertex_terms[v], model.terms);
    for (int k = 0; k < terms; ++k) {
      const MapRange& surface = model.surface_ranges[k * vertices + v];
      const MapRange& view = model.view_ranges[k * vertices + v];
      entries[k * vertices + v] = {surface.scale, surface.bias, view.scale, view.bias};
    }
  }
  return entries;
}

std::vector<TableEntry> PatchEntries(const LightFieldModel& model) {
  std::vector<TableEntry> entries;
  const auto add = [&](const std::vector<PatchPlacement>& placements) {
    for (const PatchPlacement& p : placements) {
      const int last = p.flipped ? 1 - p.edge_samples : p.edge_samples - 1;
      entries.push_back({static_cast<float>(p.origin.x()), static_cast<float>(p.origin.y()),
                         static_cast<float>(p.page), static_cast<float>(last)});
    }
  };
  add(model.placements);
  for (const auto& placements : model.surface_placements) add(placements);
  return entries;
}

std::vector<TableEntry> TileEntries(const LightFieldModel& model) {
  std::vector<TableEntry> entries;
  for (int k = 0; k < static_cast<int>(model.view_codes.size()); ++k) {
    for (const int code : model.view_codes[k]) {
      const LightFieldModel::TilePosition tile = model.ViewMapAt(k, code);
      entries.push_back({static_cast<float>(tile.x), static_cast<float>(tile.y),
                         static_cast<float>(tile.page), static_cast<float>(tile.grid)});
    }
  }
  return entries;
}

}  // namespace

GlLightFieldMaps UploadMaps(const LightFieldModel& model, BlockUse block_use) {
  if (model.terms > GlLightFieldMaps::kMostTerms) {
    throw Error("the model has " + std::to_string(model.terms) +
                " terms and 16 can be drawn; use lfm-render --renderer cpu");
  }
  GlLightFieldMaps maps;
  const LightFieldModel::Blocks& blocks = model.blocks;
  if (blocks.empty() || !ReadsBlocks(block_use)) {
    maps.mean = UploadPages("mean", ListPages(model.mean_pages));
    maps.surface = UploadPages("surface", ListPages(model.surface_pages, maps.surface_first));
    maps.view = UploadPages("view", ListPages(model.view_pages, maps.view_first));
  } else {
    maps.surface_planes = model.SurfacePlanes();
    maps.mean = UploadBlocks("mean", ListPages(blocks.mean), 1);
    maps.surface =
        UploadBlocks("surface", ListPages(blocks.surface, maps.surface_first), maps.surface_planes);
    maps.view = UploadBlocks("view", ListPages(blocks.view, maps.view_first), 1);
  }
  maps.frames = UploadTable("frames", FrameEntries(model));
  maps.ranges = UploadTable("ranges", RangeEntries(model));
  maps.patches = UploadTable("patches", PatchEntries(model));
  maps.tiles = UploadTable("tiles", TileEntries(model));
  return maps;
}

}  // namespace lfm
