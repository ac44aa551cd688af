// SPDX-License-Identifier: BSD-3-Clause
// Chen 2002, section 3, in one pass: what took a pass a map there is a loop over terms in the
// fragment shader here, so that nothing is rounded or clamped between terms.
#include "viewer/gl_renderer.h"

#include <epoxy/gl.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "core/error.h"
#include "viewer/gl_light_field_maps.h"
#include "viewer/gl_objects.h"
#include "viewer/shaders.h"

namespace lfm {
namespace {

/// One corner of one triangle as the vertex shader gets it.
struct CornerVertex {
  std::array<float, 3> position;   ///< mm, relative to the mesh's centre
  std::array<int32_t, 3> corners;  ///< the triangle's vertices
  int32_t triangle;
};

std::vector<CornerVertex> MakeCornerVertices(const LightFieldModel& model,
                                             const Eigen::Vector3d& center) {
  std::vector<CornerVertex> vertices;
  vertices.reserve(3 * model.mesh.triangles.size());
  for (size_t t = 0; t < model.mesh.triangles.size(); ++t) {
    const Eigen::Vector3i& triangle = model.mesh.triangles[t];
    for (int corner = 0; corner < 3; ++corner) {
      const Eigen::Vector3f position =
          (model.mesh.vertices[triangle[corner]] - center).cast<float>();
      vertices.push_back({{position.x(), position.y(), position.z()},
                          {triangle[0], triangle[1], triangle[2]},
                          static_cast<int32_t>(t)});
    }
  }
  return vertices;
}

void UploadVertices(const GlObject& array, const GlObject& buffer,
                    const std::vector<CornerVertex>& vertices) {
  glBindVertexArray(array.name());
  glBindBuffer(GL_ARRAY_BUFFER, buffer.name());
  glBufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(vertices.size() * sizeof(CornerVertex)),
               vertices.data(), GL_STATIC_DRAW);
  const auto offset = [](size_t bytes) { return reinterpret_cast<const void*>(bytes); };
  constexpr GLsizei kStride = sizeof(CornerVertex);
  for (GLuint location = 0; location < 3; ++location) glEnableVertexAttribArray(location);
  glVertexAttribPointer(0, 3, GL_FLOAT, GL_FALSE, kStride,
                        offset(offsetof(CornerVertex, position)));
  glVertexAttribIPointer(1, 3, GL_INT, kStride, offset(offsetof(CornerVertex, corners)));
  glVertexAttribIPointer(2, 1, GL_INT, kStride, offset(offsetof(CornerVertex, triangle)));
  glBindVertexArray(0);
  CheckGl("upload the triangles");
}

// What vertices hand over is counted in vectors of four: three a term, and four others.
int MostCornerTerms() {
  GLint out = 0, in = 0;
  glGetIntegerv(GL_MAX_VERTEX_OUTPUT_COMPONENTS, &out);
  glGetIntegerv(GL_MAX_FRAGMENT_INPUT_COMPONENTS, &in);
  return std::min(GlRenderer::kMostCornerTerms, (std::min(out, in) / 4 - 4) / 3);
}

void SetSampler(GLuint program, const char* name, GLint unit, GLenum target,
                const GlObject& texture) {
  glActiveTexture(GL_TEXTURE0 + unit);
  glBindTexture(target, texture.name());
  glUniform1i(glGetUniformLocation(program, name), unit);
}

/// The source with these lines behind its first one, which has to be the version.
std::string WithConstants(const std::string& source, const std::string& constants) {
  const size_t line = source.find('\n') + 1;
  return source.substr(0, line) + constants + source.substr(line);
}

void SetInteger(GLuint program, const char* name, int value) {
  glUniform1i(glGetUniformLocation(program, name), value);
}

void SetIntegers(GLuint program, const char* name, std::span<const int> values) {
  glUniform1iv(glGetUniformLocation(program, name), static_cast<GLsizei>(values.size()),
               values.data());
}

// What the fragment shader makes of LFM_PASS; none for all terms at once.
enum PassKind { kWholePicture = -1, kMeanPass = 0, kProductPass = 1, kPartsPass = 2 };

// Which part of the product of a surface and a view map a pass draws.
struct PaperProduct {
  float surface_sign, view_sign;
  bool added;  // else subtracted
};

}  // namespace

struct GlRenderer::State {
  /// The passes for one corner of one term.
  std::span<const PaperProduct> PaperProducts(Passes passes) const {
    static constexpr PaperProduct kParts[] = {
        {1, 1, true}, {-1, -1, true}, {1, -1, false}, {-1, 1, false}};
    static constexpr PaperProduct kSigned[] = {{1, 1, true}, {-1, 1, false}};
    const std::span<const PaperProduct> all =
        passes == Passes::kPaper ? std::span(kSigned) : std::span<const PaperProduct>(kParts);
    return mean_in_terms ? all.first(1) : all;
  }

  GlLightFieldMaps maps;
  GlObject vertex_array, vertex_buffer;
  /// By the constants in their sources, made when they are first used: a branch on a uniform costs
  /// software both ways.
  std::map<std::string, GlObject> programs;
  Sphere bounds;
  int corner_count = 0, vertex_count = 0;
  int terms = 0, grid = 2, view_tiles_per_row = 1, view_tiles_per_page = 1;
  DirectionMap direction_map = DirectionMap::kHemiOctahedral;
  bool mean_in_terms = false;
  bool codebooks = false, blocks = false;
  int surface_planes = 1, triangle_count = 0;
};

GlRenderer::GlRenderer(const LightFieldModel& model, BlockUse block_use)
    : state_(std::make_unique<State>()) {
  RequireGl33();
  ValidateModel(model, "the model");
  state_->bounds = SphereOf(model.mesh.vertices);
  state_->maps = UploadMaps(model, block_use);
  const std::vector<CornerVertex> vertices = MakeCornerVertices(model, state_->bounds.center);
  state_->corner_count = static_cast<int>(vertices.size());
  state_->vertex_array = GlObject(GlObject::Kind::kVertexArray);
  state_->vertex_buffer = GlObject(GlObject::Kind::kBuffer);
  UploadVertices(state_->vertex_array, state_->vertex_buffer, vertices);
  state_->vertex_count = static_cast<int>(model.mesh.vertices.size());
  state_->terms = model.terms;
  state_->grid = model.grid;
  state_->view_tiles_per_row = std::max(model.view_tiles_per_row, 1);
  state_->view_tiles_per_page = std::max(model.view_tiles_per_page, 1);
  state_->direction_map = model.direction_map;
  state_->mean_in_terms = model.mean_in_terms;
  state_->codebooks = !model.surface_placements.empty();
  state_->blocks = !model.blocks.empty();
  state_->surface_planes = state_->maps.surface_planes;
  state_->triangle_count = static_cast<int>(model.mesh.triangles.size());
  ProgramFor({}, kWholePicture);  // what the driver has to say about the shaders, it says now
}
GlRenderer::~GlRenderer() = default;
GlRenderer::GlRenderer(GlRenderer&&) noexcept = default;
GlRenderer& GlRenderer::operator=(GlRenderer&&) noexcept = default;

const Sphere& GlRenderer::bounds() const { return state_->bounds; }

uint32_t GlRenderer::ProgramFor(const GlRenderOptions& options, int pass_kind) const {
  const EvaluationOptions& evaluation = options.evaluation;
  const int terms = std::clamp(evaluation.terms, 0, state_->terms);
  const bool alone = evaluation.term_alone >= 0, whole = pass_kind == kWholePicture;
  const bool at_corners = options.view_coordinates == ViewCoordinates::kMapsAtCorners && whole &&
                          !alone && terms > 0 && terms <= MostCornerTerms();
  const auto constant = [](const char* name, int value) {
    return std::string("const int ") + name + " = " + std::to_string(value) + ";\n";
  };
  const auto define = [](bool wanted, const char* name, int value) {
    return wanted ? std::string("#define ") + name + " " + std::to_string(value) + "\n" : "";
  };
  const std::string constants =
      define(at_corners, "LFM_CORNER_TERMS", terms) +
      define(alone && whole, "LFM_TERM", evaluation.term_alone) +
      define(!options.tone.IsIdentity() && whole, "LFM_TONE",
             static_cast<int>(options.tone.curve)) +
      define(!whole, "LFM_PASS", pass_kind) + "#define LFM_CONSTANTS\n" +
      constant("codebooks", state_->codebooks) + constant("blocks", state_->blocks) +
      constant("surface_planes", state_->surface_planes) +
      constant("direction_map", static_cast<int>(state_->direction_map)) +
      constant("mean_in_terms", state_->mean_in_terms) +
      constant("view_coordinates_per_vertex",
               options.view_coordinates == ViewCoordinates::kPerVertex && whole) +
      constant("wireframe", options.edges == EdgeOverlay::kWireframe && whole);
  GlObject& program = state_->programs[constants];
  if (program.name() == 0) {
    program = MakeProgram(WithConstants(shaders::kLightFieldVertex, constants),
                          WithConstants(shaders::kLightFieldFragment, constants),
                          {"position", "corners", "triangle"});
  }
  return program.name();
}

void GlRenderer::Bind(uint32_t program, const GlView& view, const Placement& placement,
                      int terms) const {
  const Eigen::Vector3d& origin = state_->bounds.center;
  const Eigen::Matrix4f clip_from_model = ClipFromModel(view, placement, origin);
  const Eigen::Vector3f eye = EyeInModel(view, placement, origin);
  glUseProgram(program);
  SetSampler(program, "mean_maps", 0, GL_TEXTURE_2D_ARRAY, state_->maps.mean);
  SetSampler(program, "surface_maps", 1, GL_TEXTURE_2D_ARRAY, state_->maps.surface);
  SetSampler(program, "view_maps", 2, GL_TEXTURE_2D_ARRAY, state_->maps.view);
  SetSampler(program, "frames", 3, GL_TEXTURE_2D, state_->maps.frames);
  SetSampler(program, "ranges", 4, GL_TEXTURE_2D, state_->maps.ranges);
  SetSampler(program, "patches", 5, GL_TEXTURE_2D, state_->maps.patches);
  SetSampler(program, "tiles", 6, GL_TEXTURE_2D, state_->maps.tiles);
  SetInteger(program, "triangle_count", state_->triangle_count);
  glUniformMatrix4fv(glGetUniformLocation(program, "clip_from_model"), 1, GL_FALSE,
                     clip_from_model.data());
  glUniform3fv(glGetUniformLocation(program, "eye"), 1, eye.data());
  SetInteger(program, "terms", terms);
  SetInteger(program, "vertex_count", state_->vertex_count);
  SetInteger(program, "grid", state_->grid);
  SetIntegers(program, "surface_first", state_->maps.surface_first);
  SetIntegers(program, "view_first", state_->maps.view_first);
  SetInteger(program, "view_tiles_per_row", state_->view_tiles_per_row);
  SetInteger(program, "view_tiles_per_page", state_->view_tiles_per_page);
  glBindVertexArray(state_->vertex_array.name());
}

void GlRenderer::Draw(const Camera& camera, const Pose& camera_from_world,
                      const GlRenderOptions& options) const {
  const GlView view = ViewOf(state_->bounds, camera, camera_from_world);
  ClearPicture(options.background, options.background_alpha);
  DrawInto(view, {}, options);
}

void GlRenderer::DrawInto(const GlView& view, const Placement& placement,
                          const GlRenderOptions& options) const {
  ResetGlState();
  if (options.passes != Passes::kOne) {
    DrawPaperPasses(view, placement, options);
  } else {
    const uint32_t program = ProgramFor(options, kWholePicture);
    const int terms = std::clamp(options.evaluation.EndOfTerms(), 0, state_->terms);
    Bind(program, view, placement, terms);
    if (!options.tone.IsIdentity()) {
      glUniform1f(glGetUniformLocation(program, "exposure"),
                  static_cast<float>(std::exp2(options.tone.exposure_stops)));
    }
    glDrawArrays(GL_TRIANGLES, 0, state_->corner_count);
  }
  glBindVertexArray(0);
  glUseProgram(0);
  CheckGl("draw the model");
}

int GlRenderer::PassCount(const GlRenderOptions& options) const {
  if (options.passes == Passes::kOne) return 1;
  const int terms = std::clamp(options.evaluation.terms, 0, state_->terms);
  return 1 + 3 * terms * static_cast<int>(state_->PaperProducts(options.passes).size());
}

void GlRenderer::DrawPaperPasses(const GlView& view, const Placement& placement,
                                 const GlRenderOptions& options) const {
  const int terms = std::clamp(options.evaluation.terms, 0, state_->terms);
  Bind(ProgramFor(options, kMeanPass), view, placement, terms);
  glDrawArrays(GL_TRIANGLES, 0, state_->corner_count);

  const uint32_t program =
      ProgramFor(options, options.passes == Passes::kPaper ? kProductPass : kPartsPass);
  Bind(program, view, placement, terms);
  const GLint term_at = glGetUniformLocation(program, "pass_term");
  const GLint corner_at = glGetUniformLocation(program, "pass_corner");
  const GLint signs_at = glGetUniformLocation(program, "pass_signs");
  glDepthFunc(GL_EQUAL);
  glDepthMask(GL_FALSE);
  glEnable(GL_BLEND);
  glBlendFuncSeparate(GL_ONE, GL_ONE, GL_ZERO, GL_ONE);  // alpha stays
  for (int k = 0; k < terms; ++k) {
    for (const PaperProduct& product : state_->PaperProducts(options.passes)) {
      glBlendEquationSeparate(product.added ? GL_FUNC_ADD : GL_FUNC_REVERSE_SUBTRACT, GL_FUNC_ADD);
      glUniform2f(signs_at, product.surface_sign, product.view_sign);
      for (int corner = 0; corner < 3; ++corner) {
        glUniform1i(term_at, k);
        glUniform1i(corner_at, corner);
        glDrawArrays(GL_TRIANGLES, 0, state_->corner_count);
      }
    }
  }
  glBlendEquation(GL_FUNC_ADD);
  ResetGlState();
}

}  // namespace lfm
