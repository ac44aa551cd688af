// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>

#include "core/camera.h"
#include "core/options.h"
#include "core/pose.h"
#include "encode/model.h"
#include "encode/model_evaluation.h"
#include "viewer/gl_light_field_maps.h"
#include "viewer/gl_view.h"
#include "viewer/scene.h"
#include "viewer/tone.h"

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

/// In how many passes a picture is drawn.
enum class Passes {
  kOne,  ///< all terms at once
  /// The paper's algorithm (Chen 2002, Section 3.1), for comparison: the mean view, then the
  /// product of one surface map and one view map a pass, added to an 8-bit picture that clamps
  /// after each: three passes a term where maps are nonnegative. Where they are signed, six: the
  /// positive parts of the products are added, the negative ones subtracted.
  kPaper,
  /// The same where textures hold no negative values: twelve passes a term of signed maps, for the
  /// four products of their parts of one sign.
  kPaperUnsigned,
};

enum class EdgeOverlay { kNone, kWireframe };

struct GlRenderOptions {
  EvaluationOptions evaluation;
  ViewCoordinates view_coordinates = ViewCoordinates::kPerPixel;
  Passes passes = Passes::kOne;  ///< more than one: exact a pixel, without tone, edges, term alone
  Tone tone;
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
  explicit GlRenderer(const LightFieldModel& model, BlockUse block_use = BlockUse::kAsTheyAre);
  ~GlRenderer();
  GlRenderer(GlRenderer&&) noexcept;
  GlRenderer& operator=(GlRenderer&&) noexcept;

  /// At most, and no more than fit beside the rest into what the driver's shaders hand over: four
  /// in any OpenGL 3.3.
  static constexpr int kMostCornerTerms = 8;

  /// Clears the bound framebuffer, whose viewport is camera.width x camera.height, and draws the
  /// model where it is. Throws Error when the camera has lens distortion: a rasteriser draws
  /// pinhole pictures only.
  void Draw(const Camera& camera, const Pose& camera_from_world,
            const GlRenderOptions& options) const;
  /// Draws the model, placed, to what is there already.
  void DrawInto(const GlView& view, const Placement& placement,
                const GlRenderOptions& options) const;
  /// How often a draw goes over the mesh.
  int PassCount(const GlRenderOptions& options) const;
  /// A sphere round the mesh, in its own frame.
  const Sphere& bounds() const;

 private:
  struct State;
  uint32_t ProgramFor(const GlRenderOptions& options, int pass_kind) const;
  void Bind(uint32_t program, const GlView& view, const Placement& placement, int terms) const;
  void DrawPaperPasses(const GlView& view, const Placement& placement,
                       const GlRenderOptions& options) const;
  std::unique_ptr<State> state_;
};

}  // namespace lfm
