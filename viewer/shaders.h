// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace lfm::shaders {

/// GLSL 330 sources of viewer/shaders/, put into the program when it is configured.
extern const char* const kLightFieldVertex;
extern const char* const kLightFieldFragment;

}  // namespace lfm::shaders
