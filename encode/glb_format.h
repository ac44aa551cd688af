// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// Names and numbers of the extension LFM_surface_light_field that writer and reader share
/// (docs/formats.md).
namespace lfm::glb {

inline constexpr const char* kExtension = "LFM_surface_light_field";
inline constexpr int kVersion = 4;  ///< of models whose view maps have grids of their own
inline constexpr int kVersionOfWholeViews = 3;  ///< of all others
inline constexpr int kOldestVersion = 2;        ///< still read: has no codebooks and no blocks
/// Of surface pages in blocks, by their planes; mean and view pages are bc1.
inline constexpr const char* kOnePlane = "bc1";
inline constexpr const char* kThreePlanes = "bc4";
/// In the order of DirectionMap.
inline constexpr const char* kDirectionMapNames[] = {"hemi-octahedral", "orthographic",
                                                     "hemi-octahedral-skirt"};
inline constexpr int kPngCompression = 3;
inline constexpr int kMaxTerms = 16;
inline constexpr int kMaxTextureSize = 16384;

}  // namespace lfm::glb
