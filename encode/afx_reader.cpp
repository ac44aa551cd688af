// SPDX-License-Identifier: BSD-3-Clause
// Trusts nothing: sizes follow from the file's own length and from pictures' headers, and are
// bounded before anything is decoded or laid out. Rows of pictures run upwards here, as texture
// coordinates do.
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <span>
#include <tuple>
#include <utility>

#include "core/atomic_file.h"
#include "core/error.h"
#include "core/parallel.h"
#include "encode/afx.h"
#include "encode/afx_content.h"
#include "encode/afx_frames.h"
#include "encode/afx_layout.h"
#include "encode/afx_pictures.h"
#include "encode/file_errors.h"
#include "encode/glb_format.h"
#include "encode/gutters.h"
#include "encode/model_layout.h"
#include "encode/png_header.h"
#include "encode/quantization.h"
#include "encode/vrml_tokens.h"
#include "resample/light_field.h"

namespace lfm {
namespace {

using afx::Content;

constexpr int64_t kMostTexels = int64_t{1} << 28;  // of all pictures, and of the model's pages

// The picture of a tile: its bytes until it is decoded.
struct Tile {
  std::string png;
  PngHeader header;
  Image image;
};

// Sample (i, j) of a patch lies at texel first + i right + j up.
struct Patch {
  Eigen::Vector2i first = {0, 0}, right = {0, 0}, up = {0, 0};
  int edge_samples = 0;
};

class Reader {
 public:
  Reader(Content content, const std::string& name, const AfxPictureSource& pictures)
      : content_(std::move(content)), name_(name), pictures_(pictures) {}

  LightFieldModel Read() {
    ReadTileHeaders();
    for (const afx::SurfaceEntry& entry : content_.plain) plain_.push_back(FindPatch(entry));
    for (const afx::SurfaceEntry& entry : content_.surfaces) surfaces_.push_back(FindPatch(entry));
    for (const afx::ViewEntry& entry : content_.views) view_tiles_.push_back(FindViewTile(entry));
    CheckWork();
    DecodeTiles();
    LightFieldModel model = MakeModel();
    ValidateModel(model, name_);
    return FillGutters(std::move(model));
  }

 private:
  [[noreturn]] void Fail(int line, const std::string& problem) const {
    vrml::FailAt(name_, line, problem);
  }
  void Require(bool condition, int line, const char* problem) const {
    if (!condition) Fail(line, problem);
  }

  void ReadTileHeaders() {
    int64_t texels = 0;
    for (const afx::TileName& tile : content_.tiles) {
      std::string png = pictures_(tile.name);
      const std::optional<PngHeader> header = ReadPngHeader(png);
      const std::string what = "picture " + vrml::Quoted(tile.name);
      if (!header) Fail(tile.line, what + " is not a PNG");
      if (!afx::FitsItsName(tile.name, png)) {
        Fail(tile.line, what + " is not the one written under that name: swapped, or damaged");
      }
      if (header->bit_depth != 8 || header->channels == 0) {
        Fail(tile.line, what + " is neither 8-bit grey nor 8-bit RGB");
      }
      if (std::min(header->width, header->height) < 1 ||
          std::max(header->width, header->height) > glb::kMaxTextureSize) {
        Fail(tile.line, what + " is larger than 16384 texels a side, or empty");
      }
      texels += header->width * header->height;
      Require(texels <= kMostTexels, tile.line, "the pictures hold more texels than a model may");
      tiles_.push_back({std::move(png), *header, {}});
    }
  }

  // The texel whose centre a texture coordinate names.
  Eigen::Vector2i Texel(const Eigen::Vector2f& coordinate, int tile, int line) const {
    const PngHeader& header = tiles_[tile].header;
    const Eigen::Vector2d size(static_cast<double>(header.width),
                               static_cast<double>(header.height));
    const Eigen::Vector2d at =
        coordinate.cast<double>().cwiseProduct(size) - Eigen::Vector2d::Constant(0.5);
    const Eigen::Vector2d whole = at.array().round();
    constexpr double kCentre_texels = 0.05;
    Require((at - whole).cwiseAbs().maxCoeff() < kCentre_texels, line,
            "texture coordinates do not lie at the centres of texels");
    Require(whole.minCoeff() >= 0 && whole.x() < size.x() && whole.y() < size.y(), line,
            "texture coordinates lie outside their tile");
    return whole.cast<int>();
  }

  Patch FindPatch(const afx::SurfaceEntry& entry) const {
    const Eigen::Vector2i a = Texel(entry.corners[0], entry.tile, entry.line),
                          b = Texel(entry.corners[1], entry.tile, entry.line),
                          c = Texel(entry.corners[2], entry.tile, entry.line);
    const int last = (b - a).cwiseAbs().maxCoeff();
    const bool right_angled = last >= 1 && last < kMaxEdgeSamples &&
                              (c - a).cwiseAbs().maxCoeff() == last && (b - a).dot(c - a) == 0 &&
                              (b - a).cwiseAbs().minCoeff() == 0;
    Require(right_angled, entry.line,
            "a surface map is not a right-angled triangle with legs of equal length along the "
            "texels, 2 to 257 long");
    return {a, (b - a) / last, (c - a) / last, last + 1};
  }

  // The texel of the square's corner (0, 0); the grid must be that of all.
  Eigen::Vector2i FindViewTile(const afx::ViewEntry& entry) {
    const Eigen::Vector2i first = Texel(entry.origin, entry.tile, entry.line),
                          last = Texel(entry.origin + entry.size, entry.tile, entry.line);
    const int grid = last.x() - first.x() + 1;
    Require(last.y() - first.y() + 1 == grid && grid >= 2 && grid <= 256, entry.line,
            "a view map is not a square of 2 to 256 texels a side");
    Require(grid_ == 0 || grid_ == grid, entry.line, "view maps are not all of one size");
    grid_ = grid;
    return first;
  }

  // What the model will take, and that each of its maps is given once.
  void CheckWork() {
    edge_samples_.assign(content_.mesh.triangles.size(), 0);
    const auto agree = [this](const std::vector<afx::SurfaceEntry>& entries,
                              const std::vector<Patch>& patches) {
      for (size_t i = 0; i < entries.size(); ++i) {
        int& n = edge_samples_[entries[i].triangle];
        Require(n == 0 || n == patches[i].edge_samples, entries[i].line,
                "the surface maps of a triangle differ in size");
        n = patches[i].edge_samples;
      }
    };
    agree(content_.plain, plain_);
    agree(content_.surfaces, surfaces_);
    vertex_terms_.assign(content_.mesh.vertices.size(), 0);
    for (const afx::ViewEntry& view : content_.views) ++vertex_terms_[view.vertex];
    int64_t texels = static_cast<int64_t>(content_.views.size()) * grid_ * grid_;
    for (size_t t = 0; t < edge_samples_.size(); ++t) {
      int& n = edge_samples_[t];
      n = std::max(n, 2);
      int terms = 0;
      for (const int v : content_.mesh.triangles[t]) terms = std::max(terms, vertex_terms_[v]);
      texels += int64_t{n + 4} * (n + 3) / 2 * (1 + terms);
    }
    Require(texels <= kMostTexels, 1, "its maps hold more texels than a model may have");
  }

  void DecodeTiles() {
    ParallelFor(0, static_cast<int64_t>(tiles_.size()), [&](int64_t i) {
      Tile& tile = tiles_[i];
      const std::string what = name_ + ", picture " + vrml::Quoted(content_.tiles[i].name);
      tile.image =
          DecodeImage(reinterpret_cast<const std::byte*>(tile.png.data()), tile.png.size(), what);
      const bool same =
          tile.image.width() == tile.header.width && tile.image.height() == tile.header.height &&
          tile.image.channels() == tile.header.channels && tile.image.type() == PixelType::kUint8;
      if (!same) throw Error(what + ": differs from its header; run lfm-encode again");
      tile.png = {};
    });
  }

  const uint8_t* At(int tile, const Eigen::Vector2i& texel) const {
    const Image& image = tiles_[tile].image;
    return &image.At<uint8_t>(texel.x(), image.height() - 1 - texel.y());
  }

  std::vector<Eigen::Matrix3d> Frames() const {
    const std::vector<Eigen::Matrix3d> automatic = AutomaticAfxFrames(content_.mesh);
    std::vector<Eigen::Matrix3d> frames = content_.given_frames;
    for (size_t v = 0; v < frames.size(); ++v) {
      if (frames[v].isZero(0)) frames[v] = automatic[v];
    }
    return frames;
  }

  LightFieldModel MakeModel() {
    std::vector<Eigen::Matrix3d> frames = Frames();
    // A frame that is left-handed, as the automatic ones are, becomes right-handed with y turned
    // round, and so do the rows of its view maps.
    std::vector<uint8_t> mirrored(frames.size(), 0);
    for (size_t v = 0; v < frames.size(); ++v) {
      if (frames[v].determinant() > 0) continue;
      frames[v].col(1) *= -1;
      mirrored[v] = 1;
    }
    int side = kLeastSide;
    for (const Tile& tile : tiles_)
      side = std::max({side, tile.image.width(), tile.image.height()});
    for (const int n : edge_samples_) side = std::max(side, n + 4);
    const LightFieldSource source{
        content_.mesh, frames, content_.direction_map, std::max(grid_, 2), {}, {}, 0};
    LightFieldModel model = LayOutOnSide(source, edge_samples_, vertex_terms_, side);
    for (const Eigen::Matrix3d& frame : model.vertex_frames) {
      model.mesh.normals.push_back(frame.col(2));
    }
    WriteMeans(model);
    WriteTerms(mirrored, model);
    return model;
  }

  void WriteMeans(LightFieldModel& model) const {
    std::vector<uint8_t> written(edge_samples_.size(), 0);
    for (size_t e = 0; e < plain_.size(); ++e) {
      const afx::SurfaceEntry& entry = content_.plain[e];
      Require(written[entry.triangle]++ == 0, entry.line, "a triangle has two plain textures");
      const Patch& patch = plain_[e];
      const int n = patch.edge_samples, channels = tiles_[entry.tile].image.channels();
      std::vector<uint8_t> codes;
      for (int j = 0; j < n; ++j) {
        for (int i = 0; i + j < n; ++i) {
          const uint8_t* texel = At(entry.tile, patch.first + i * patch.right + j * patch.up);
          for (int c = 0; c < 3; ++c) {
            codes.push_back(InRange(content_.textures[e], c, texel[channels == 3 ? c : 0]));
          }
        }
      }
      WriteMean(codes, entry.triangle, model);
    }
  }

  // A texture's code with its scale and bias.
  static uint8_t InRange(const afx::LightMap& map, int channel, uint8_t code) {
    return QuantizeValue({1, 0}, DecodeValue({map.scale[channel], map.bias[channel]}, code));
  }

  // The surface maps of each vertex and term, sorted by triangle.
  struct MapPiece {
    int vertex, term, triangle;
    size_t entry;
    bool operator<(const MapPiece& other) const {
      return std::tie(vertex, term, triangle) < std::tie(other.vertex, other.term, other.triangle);
    }
  };

  std::vector<MapPiece> SortedPieces() const {
    std::vector<MapPiece> pieces;
    for (size_t e = 0; e < surfaces_.size(); ++e) {
      const afx::SurfaceEntry& entry = content_.surfaces[e];
      const afx::ViewEntry& view = content_.views[entry.view_entry];
      const Eigen::Vector3i& corners = content_.mesh.triangles[entry.triangle];
      Require((corners.array() == view.vertex).any(), entry.line,
              "a surface map names a view map of a vertex that its triangle does not have");
      pieces.push_back({view.vertex, view.term, entry.triangle, e});
    }
    std::sort(pieces.begin(), pieces.end());
    for (size_t i = 0; i + 1 < pieces.size(); ++i) {
      Require(pieces[i] < pieces[i + 1], content_.surfaces[pieces[i].entry].line,
              "a triangle has two surface maps for one view map");
    }
    return pieces;
  }

  // The range of a light map's surface maps, and that of a map that is subtracted: codes are turned
  // round, and what decoded to zero exactly still does.
  static MapRange SurfaceRangeOf(const afx::LightMap& map) {
    const MapRange range{map.scale[0], map.bias[0]};
    if (!map.subtracted) return range;
    const uint8_t zero = ZeroCode(range);
    if (DecodeValue(range, zero) == 0) {
      return {range.scale, -(range.scale * static_cast<float>(255 - zero) / 255)};
    }
    return {range.scale, -(range.scale + range.bias)};
  }

  void WriteTerms(const std::vector<uint8_t>& mirrored, LightFieldModel& model) const {
    const std::vector<MapPiece> pieces = SortedPieces();
    std::vector<std::vector<size_t>> views(vertex_terms_.size());
    for (size_t i = 0; i < content_.views.size(); ++i) {
      views[content_.views[i].vertex].push_back(i);  // in the order of their terms
    }
    const VertexRings rings = ComputeVertexRings(content_.mesh);
    ParallelFor(0, static_cast<int64_t>(views.size()), [&](int64_t v) {
      const auto ring = rings.Ring(v);
      std::vector<TermMaps> terms;
      for (const size_t view : views[v]) {
        terms.push_back(ViewMaps(content_.views[view], view_tiles_[view], mirrored[v] != 0));
        AddSurfaceMaps(pieces, ring, content_.views[view], terms.back());
      }
      WriteVertexTerms(ring, terms, static_cast<int>(v), model);
    });
  }

  TermMaps ViewMaps(const afx::ViewEntry& entry, const Eigen::Vector2i& first,
                    bool mirrored) const {
    const afx::LightMap& map = content_.light_maps[entry.light_map];
    TermMaps maps{SurfaceRangeOf(map), {map.scale[0], map.bias[0]}, {}, {}};
    const int channels = tiles_[entry.tile].image.channels();
    for (int y = 0; y < grid_; ++y) {
      for (int x = 0; x < grid_; ++x) {
        const Eigen::Vector2i texel = first + Eigen::Vector2i(x, mirrored ? grid_ - 1 - y : y);
        for (int c = 0; c < 3; ++c) {
          maps.view_codes.push_back(At(entry.tile, texel)[channels == 3 ? c : 0]);
        }
      }
    }
    return maps;
  }

  // Triangles of the ring that have no map of the term have zeros.
  void AddSurfaceMaps(const std::vector<MapPiece>& pieces, std::span<const int> ring,
                      const afx::ViewEntry& view, TermMaps& maps) const {
    const bool subtracted = content_.light_maps[view.light_map].subtracted;
    for (const int triangle : ring) {
      const MapPiece wanted{view.vertex, view.term, triangle, 0};
      const auto piece = std::lower_bound(pieces.begin(), pieces.end(), wanted);
      const int n = edge_samples_[triangle];
      if (piece == pieces.end() || wanted < *piece) {
        maps.surface_codes.insert(maps.surface_codes.end(), PatchSampleCount(n),
                                  ZeroCode(maps.surface_range));
        continue;
      }
      const Patch& patch = surfaces_[piece->entry];
      const afx::SurfaceEntry& entry = content_.surfaces[piece->entry];
      const bool colored = tiles_[entry.tile].image.channels() == 3;
      for (int j = 0; j < n; ++j) {
        for (int i = 0; i + j < n; ++i) {
          const uint8_t* texel = At(entry.tile, patch.first + i * patch.right + j * patch.up);
          Require(!colored || (texel[0] == texel[1] && texel[0] == texel[2]), entry.line,
                  "a surface map is coloured: only grey ones can be read");
          maps.surface_codes.push_back(subtracted ? 255 - texel[0] : texel[0]);
        }
      }
    }
  }

  Content content_;
  const std::string& name_;
  const AfxPictureSource& pictures_;
  std::vector<Tile> tiles_;
  std::vector<Patch> plain_, surfaces_;
  std::vector<Eigen::Vector2i> view_tiles_;
  std::vector<int> edge_samples_, vertex_terms_;
  int grid_ = 0;
};

// The path of a picture that a file names; it must lie in the file's folder or below.
std::filesystem::path PicturePath(const std::filesystem::path& folder, const std::string& name,
                                  const std::string& file) {
  const std::filesystem::path path(name);
  const auto fail = [&](const char* problem) {
    throw Error(file + ": picture " + vrml::Quoted(name) + " " + problem +
                "; keep the pictures beside the file");
  };
  const bool plain = !name.empty() && std::none_of(name.begin(), name.end(), [](unsigned char c) {
    return c == '\\' || c == ':' || c < 0x20 || c == 0x7f;
  });
  if (!plain || path.is_absolute()) fail("is not named by a relative path");
  std::error_code error;
  const std::filesystem::path root = std::filesystem::weakly_canonical(
      folder.empty() ? std::filesystem::path(".") : folder, error);
  const std::filesystem::path target = std::filesystem::weakly_canonical(root / path, error);
  const auto [end, ignored] = std::mismatch(root.begin(), root.end(), target.begin(), target.end());
  if (error || end != root.end() || std::find(path.begin(), path.end(), "..") != path.end()) {
    fail("leaves the file's folder");
  }
  return target;
}

}  // namespace

LightFieldModel ReadAfxText(std::string_view text, const std::string& name,
                            const AfxPictureSource& pictures, const AfxReadOptions& options) {
  return NamingFile(name, [&] {
    return Reader(afx::CollectContent(vrml::ParseScene(text, name), name, options), name, pictures)
        .Read();
  });
}

LightFieldModel ReadAfx(const std::filesystem::path& file, const AfxReadOptions& options) {
  const std::string text = ReadFile(file), name = file.string();
  constexpr size_t kMostPictureBytes = size_t{1} << 30;
  const AfxPictureSource pictures = [&](const std::string& picture) {
    return ReadFile(PicturePath(file.parent_path(), picture, name), kMostPictureBytes);
  };
  return ReadAfxText(text, name, pictures, options);
}

}  // namespace lfm
