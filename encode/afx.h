// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <functional>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include "encode/model.h"

namespace lfm {

/// Models as MPEG-4 AFX has them (ISO/IEC 14496-16; Smirnov, Molinov, Simakov, Grzeszczuk, "Light
/// Field Mapping", Section 2): a VRML97 file with LFM_Appearance nodes, and pictures beside it
/// (docs/formats.md).

/// What becomes of view maps that are not on the disc which AFX knows.
enum class AfxViewMaps {
  kDisc,      ///< resampled onto it: any reader of AFX shows them
  kAsTheyAre  ///< kept, and named in a field that AFX does not have: only our reader shows them
};

/// The model that an AFX file of `model` holds: each term is one light map, with one range for the
/// surface and view maps of all its vertices, view maps are on the disc (unless kAsTheyAre),
/// triangles are in the order of their pages, coordinates and frames are float32, pages laid out
/// anew on sides no longer than the longest of `model`'s. Codes on shared edges stay equal.
///
/// A model that is of this form already keeps its maps, also one of a file that has several light
/// maps a term: AfxForm(AfxForm(m)) is AfxForm(m), so that writing what was read gives the same
/// bytes. Throws Error for nonnegative terms that hold the mean view (AFX would add it twice),
/// models with codebooks, and those that are not consistent.
LightFieldModel AfxForm(const LightFieldModel& model, AfxViewMaps view_maps);

/// A file and its pictures.
struct AfxFiles {
  struct Picture {
    std::string name;  ///< as the file names it: "model_afx/mean-0-1a2b3c4d5e6f.png"
    std::vector<std::byte> png;
  };
  std::string wrl;
  std::vector<Picture> pictures;
};

/// Writes a model of AFX form; throws Error for any other. Pictures' names hold a hash of their
/// content. Any VRML97 browser shows the mean view: prototypes whose first node is a plain
/// Appearance stand before the scene.
AfxFiles WriteAfxForm(const LightFieldModel& model);

/// Writes `folder/model.wrl` and its pictures. The pictures come first, then the file takes its
/// name, then pictures of an earlier file go: at no time does the file name one that is not its
/// own. Returns the bytes of all.
int64_t SaveAfx(const AfxFiles& files, const std::filesystem::path& folder);
/// Removes what SaveAfx wrote, if anything.
void RemoveAfx(const std::filesystem::path& folder);

struct AfxReadOptions {
  /// Light maps of a higher priority level are left out. Ours have 0 for the mean view, k for term
  /// k.
  int priority_level = std::numeric_limits<int>::max();
};

/// Gives the bytes of a picture by the name that the file has for it.
using AfxPictureSource = std::function<std::string(const std::string& name)>;

/// Reads a file; pictures are looked for beside it and must lie in its folder or below. Light maps
/// without view maps are the mean view, the others terms in the order of `lightMapList`; blend mode
/// LFM_SUBTRACT turns the sign of a term. Vertices without a frame get the automatic one. All
/// shapes with LFM_Appearance make up the model, in the coordinates of their face sets.
///
/// Throws Error, with file and line, for files that are damaged or hostile, and for what a model
/// cannot hold: patches that are not right-angled on texel centres, coloured surface maps, scales
/// that differ between channels, view maps of different sizes, more than 16 terms a vertex. What it
/// returns is safe to evaluate.
LightFieldModel ReadAfx(const std::filesystem::path& file, const AfxReadOptions& options = {});
LightFieldModel ReadAfxText(std::string_view text, const std::string& name,
                            const AfxPictureSource& pictures, const AfxReadOptions& options = {});

}  // namespace lfm
