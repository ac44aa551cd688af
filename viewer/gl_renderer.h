// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>

#include "core/camera.h"
#include "core/options.h"
#include "core/pose.h"
#include "encode/model.h"
#include "encode/model_evaluation.h"
#include "viewer/gl_light_field_maps.h"

namespace lfm {

/// Where the direction of view is turned into view map coordinates.
enum class ViewCoordinates {
  kPerPixel,   ///< exact, as the reference renderer does
  kPerVertex,  ///< the paper's form (Equation 7): at the corners, interpolated over the triangle
  /// View maps are read at the corners, and what they say is interpolated: far fewer readings,
  /// since triangles have fewer corners than pixels; a triangle spans less than a texel of a view
  /// map. More than kMostCornerTerms terms are drawn as with kPerPixel.
  kMapsAtCorners,
};

/// The option of the commands that draw with OpenGL.
inline void DeclareViewCoordinates(OptionVisitor& v, ViewCoordinates& value) {
  v.Enumeration(
      {"view-coordinates",
       "Where the direction of view is turned into places of view maps: at each pixel, "
       "exact; at the triangles' corners, as the paper does (vertex); or view maps are "
       "read at the corners altogether (corner-maps; of up to 8 terms, as the driver allows, else "
       "pixel): fastest."},
      {"pixel", "vertex", "corner-maps"}, value);
}

enum class EdgeOverlay { kNone, kWireframe };

struct GlRenderOptions {
  EvaluationOptions evaluation;
  ViewCoordinates view_coordinates = ViewCoordinates::kPerPixel;
  EdgeOverlay edges = EdgeOverlay::kNone;
  Eigen::Vector3f background = {0, 0, 0};  ///< sRGB-coded
  float background_alpha = 1;              ///< of a framebuffer that has alpha; the model has 1
};

/// Draws a model with OpenGL 3.3: all terms in one pass, float arithmetic on sRGB-coded values,
/// clamped at the end (Chen 2002, Equation 6). Needs a current context, the same one for its whole
/// life. Agrees with ReferenceRenderer but for the precision of the texture units' bilinear
/// filter (8 bits of weight), and at silhouettes within one pixel.
class GlRenderer {
 public:
  /// Uploads the model; it is not needed afterwards. Throws Error as UploadMaps does, and (kSystem)
  /// when the context is older than 3.3.
  explicit GlRenderer(const LightFieldModel& model, BlockUse block_use = {});
  ~GlRenderer();
  GlRenderer(GlRenderer&&) noexcept;

  /// At most, and no more than fit beside the rest into what the driver's shaders hand over: four
  /// in any OpenGL 3.3.
  static constexpr int kMostCornerTerms = 8;

  /// Clears the bound framebuffer, whose viewport is camera.width x camera.height, and draws.
  /// Throws Error when the camera has lens distortion: a rasteriser draws pinhole pictures only.
  void Draw(const Camera& camera, const Pose& camera_from_world,
            const GlRenderOptions& options) const;

 private:
  struct State;
  uint32_t ProgramFor(const GlRenderOptions& options) const;
  std::unique_ptr<State> state_;
};

}  // namespace lfm
