// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// Names and numbers of the extension LFM_surface_light_field that writer and reader share
/// (docs/formats.md).
namespace lfm::glb {

inline constexpr const char* kExtension = "LFM_surface_light_field";
inline constexpr int kVersion = 2;
/// In the order of DirectionMap.
inline constexpr const char* kDirectionMapNames[] = {"hemi-octahedral", "orthographic"};
inline constexpr int kPngCompression = 3;
inline constexpr int kMaxTerms = 16;
inline constexpr int kMaxTextureSize = 16384;

}  // namespace lfm::glb
