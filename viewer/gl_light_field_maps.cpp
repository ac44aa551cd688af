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
                std::to_string(max_size) + ", or use lfm-render");
  }
  if (layers > static_cast<size_t>(max_layers)) {
    throw Error("the model has " + std::to_string(layers) + " " + what +
                " pages and this graphics card takes " + std::to_string(max_layers) +
                "; encode again with a larger --max-texture-size, or use lfm-render");
  }
}

/// Pages of unequal size share the array of the largest one; coordinates are in texels, so the
/// unused rest is never read.
GlObject UploadPages(const std::string& what, const std::vector<const Image*>& pages) {
  int width = 1, height = 1;
  for (const Image* page : pages) {
    width = std::max(width, page->width());
    height = std::max(height, page->height());
  }
  CheckLimits(what, width, height, pages.size());
  GlObject texture(GlObject::Kind::kTexture);
  glBindTexture(GL_TEXTURE_2D_ARRAY, texture.name());
  glTexImage3D(GL_TEXTURE_2D_ARRAY, 0, GL_RGB8, width, height,
               static_cast<GLsizei>(std::max<size_t>(pages.size(), 1)), 0, GL_RGB, GL_UNSIGNED_BYTE,
               nullptr);
  CheckGl("upload the " + what + " maps");
  glTexParameteri(GL_TEXTURE_2D_ARRAY, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
  glTexParameteri(GL_TEXTURE_2D_ARRAY, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
  glTexParameteri(GL_TEXTURE_2D_ARRAY, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
  glTexParameteri(GL_TEXTURE_2D_ARRAY, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
  glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
  for (size_t layer = 0; layer < pages.size(); ++layer) {
    glTexSubImage3D(GL_TEXTURE_2D_ARRAY, 0, 0, 0, static_cast<GLint>(layer), pages[layer]->width(),
                    pages[layer]->height(), 1, GL_RGB, GL_UNSIGNED_BYTE,
                    pages[layer]->Data<uint8_t>());
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
                "); use lfm-render");
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
std::vector<const Image*> ListPages(const std::vector<std::vector<Image>>& terms,
                                    std::array<int, GlLightFieldMaps::kMostTerms>& first) {
  std::vector<const Image*> pages;
  for (size_t k = 0; k < terms.size(); ++k) {
    first[k] = static_cast<int>(pages.size());
    for (const Image& page : terms[k]) pages.push_back(&page);
  }
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

}  // namespace

GlLightFieldMaps UploadMaps(const LightFieldModel& model) {
  std::vector<const Image*> mean_pages;
  for (const Image& page : model.mean_pages) mean_pages.push_back(&page);
  if (model.terms > GlLightFieldMaps::kMostTerms) {
    throw Error("the model has " + std::to_string(model.terms) + " terms; 16 can be drawn");
  }
  GlLightFieldMaps maps;
  maps.mean = UploadPages("mean", mean_pages);
  maps.surface = UploadPages("surface", ListPages(model.surface_pages, maps.surface_first));
  maps.view = UploadPages("view", ListPages(model.view_pages, maps.view_first));
  maps.frames = UploadTable("frames", FrameEntries(model));
  maps.ranges = UploadTable("ranges", RangeEntries(model));
  return maps;
}

}  // namespace lfm
