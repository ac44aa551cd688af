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

/// Clip space of a pinhole: pixel centres at integers in the picture, at halves in the window,
/// whose rows count from the bottom.
Eigen::Matrix4d ClipFromCamera(const Camera& camera, double near, double far) {
  Eigen::Matrix4d clip = Eigen::Matrix4d::Zero();
  clip(0, 0) = 2 * camera.fx / camera.width;
  clip(0, 2) = 2 * (camera.cx + 0.5) / camera.width - 1;
  clip(1, 1) = -2 * camera.fy / camera.height;
  clip(1, 2) = 1 - 2 * (camera.cy + 0.5) / camera.height;
  clip(2, 2) = (far + near) / (far - near);
  clip(2, 3) = -2 * far * near / (far - near);
  clip(3, 2) = 1;
  return clip;
}

Eigen::Matrix4d CameraFromModel(const Pose& camera_from_world, const Eigen::Vector3d& center) {
  Eigen::Matrix4d matrix = Eigen::Matrix4d::Identity();
  matrix.topLeftCorner<3, 3>() = camera_from_world.rotation;
  matrix.topRightCorner<3, 1>() = camera_from_world * center;
  return matrix;
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

}  // namespace

struct GlRenderer::State {
  GlLightFieldMaps maps;
  GlObject vertex_array, vertex_buffer;
  /// By the constants in their sources, made when they are first used: a branch on a uniform costs
  /// software both ways.
  std::map<std::string, GlObject> programs;
  Eigen::Vector3d center;
  double radius = 1;  ///< of the mesh round center, mm
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
  Eigen::Vector3d low = model.mesh.vertices[0], high = low;
  for (const Eigen::Vector3d& vertex : model.mesh.vertices) {
    low = low.cwiseMin(vertex);
    high = high.cwiseMax(vertex);
  }
  state_->center = (low + high) / 2;
  state_->radius = std::max((high - low).norm() / 2, 1e-6);
  state_->maps = UploadMaps(model, block_use);
  const std::vector<CornerVertex> vertices = MakeCornerVertices(model, state_->center);
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
  ProgramFor({});  // what the driver has to say about the shaders, it says now
}
GlRenderer::~GlRenderer() = default;
GlRenderer::GlRenderer(GlRenderer&&) noexcept = default;

uint32_t GlRenderer::ProgramFor(const GlRenderOptions& options) const {
  const int terms = std::clamp(options.evaluation.terms, 0, state_->terms);
  const bool at_corners = options.view_coordinates == ViewCoordinates::kMapsAtCorners &&
                          terms > 0 && terms <= MostCornerTerms();
  const auto constant = [](const char* name, int value) {
    return std::string("const int ") + name + " = " + std::to_string(value) + ";\n";
  };
  const std::string constants =
      (at_corners ? "#define LFM_CORNER_TERMS " + std::to_string(terms) + "\n" : "") +
      "#define LFM_CONSTANTS\n" + constant("codebooks", state_->codebooks) +
      constant("blocks", state_->blocks) + constant("surface_planes", state_->surface_planes) +
      constant("direction_map", static_cast<int>(state_->direction_map)) +
      constant("mean_in_terms", state_->mean_in_terms) +
      constant("view_coordinates_per_vertex",
               options.view_coordinates == ViewCoordinates::kPerVertex) +
      constant("wireframe", options.edges == EdgeOverlay::kWireframe);
  GlObject& program = state_->programs[constants];
  if (program.name() == 0) {
    program = MakeProgram(WithConstants(shaders::kLightFieldVertex, constants),
                          WithConstants(shaders::kLightFieldFragment, constants),
                          {"position", "corners", "triangle"});
  }
  return program.name();
}

void GlRenderer::Draw(const Camera& camera, const Pose& camera_from_world,
                      const GlRenderOptions& options) const {
  ValidateCamera(camera, "the camera to draw");
  if (camera.HasDistortion()) {
    throw Error(
        "OpenGL draws pinhole pictures and this camera's lens distorts; use lfm-render "
        "--renderer cpu");
  }
  const double depth = (camera_from_world * state_->center).z();
  const double far = std::max(depth + 1.01 * state_->radius, 1e-3 * state_->radius);
  const double near = std::max(depth - 1.01 * state_->radius, 1e-3 * far);
  const Eigen::Matrix4f clip_from_model =
      (ClipFromCamera(camera, near, far) * CameraFromModel(camera_from_world, state_->center))
          .cast<float>();
  const Eigen::Vector3f eye = (camera_from_world.Center() - state_->center).cast<float>();

  glDisable(GL_BLEND);
  glDisable(GL_CULL_FACE);
  glDisable(GL_SCISSOR_TEST);
  glDisable(GL_FRAMEBUFFER_SRGB);
  glDisable(GL_DITHER);
  glEnable(GL_DEPTH_TEST);
  glDepthFunc(GL_LESS);
  glClearColor(options.background[0], options.background[1], options.background[2],
               options.background_alpha);
  glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);

  const GLuint program = ProgramFor(options);
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
  SetInteger(program, "terms", std::clamp(options.evaluation.terms, 0, state_->terms));
  SetInteger(program, "vertex_count", state_->vertex_count);
  SetInteger(program, "grid", state_->grid);
  SetIntegers(program, "surface_first", state_->maps.surface_first);
  SetIntegers(program, "view_first", state_->maps.view_first);
  SetInteger(program, "view_tiles_per_row", state_->view_tiles_per_row);
  SetInteger(program, "view_tiles_per_page", state_->view_tiles_per_page);
  glBindVertexArray(state_->vertex_array.name());
  glDrawArrays(GL_TRIANGLES, 0, state_->corner_count);
  glBindVertexArray(0);
  glUseProgram(0);
  CheckGl("draw the model");
}

}  // namespace lfm
