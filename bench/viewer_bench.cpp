// SPDX-License-Identifier: BSD-3-Clause
// Times drawing: OpenGL's ways against a plain draw of the same mesh with one texture, on the same
// driver and in turns, and the reference renderer against casting its rays alone.
//
//   lfm-bench-viewer MODEL|SCENE... [--terms K] [--blocks-as-they-are] [--by-terms]
//
// 1024 x 768, the object over about a third of the picture. Medians of 15 frames. --by-terms: rate
// against the number of terms, in one pass and by the paper's algorithm (its Figure 10). Of a scene
// file: frames a second of both renderers with one term, and with all.
#include <epoxy/gl.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <functional>
#include <string>
#include <vector>

#include "core/error.h"
#include "core/image_metrics.h"
#include "core/ray_scene.h"
#include "encode/transport_form.h"
#include "viewer/egl_context.h"
#include "viewer/gl_framebuffer.h"
#include "viewer/gl_objects.h"
#include "viewer/gl_renderer.h"
#include "viewer/gl_scene.h"
#include "viewer/orbit_camera.h"
#include "viewer/reference_renderer.h"
#include "viewer/scene.h"
#include "viewer/scene_reading.h"

namespace {

constexpr int kWidth = 1024, kHeight = 768, kFrames = 15, kPictures = 5;

double Milliseconds(const std::function<void()>& work) {
  const auto start = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start)
      .count();
}

double Median(std::vector<double> values) {
  std::nth_element(values.begin(), values.begin() + values.size() / 2, values.end());
  return values[values.size() / 2];
}

// The mesh with its first mean page: what any viewer of textured meshes does a frame.
class PlainDraw {
 public:
  PlainDraw(const lfm::LightFieldModel& model, const lfm::Camera& camera, const lfm::Pose& pose)
      : program_(lfm::MakeProgram(kVertex, kFragment, {"clip", "texcoord"})),
        array_(lfm::GlObject::Kind::kVertexArray),
        buffer_(lfm::GlObject::Kind::kBuffer),
        texture_(lfm::GlObject::Kind::kTexture) {
    const lfm::Image& page = model.mean_pages.front();
    glBindTexture(GL_TEXTURE_2D, texture_.name());
    glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
    glTexImage2D(GL_TEXTURE_2D, 0, GL_RGB8, page.width(), page.height(), 0, GL_RGB,
                 GL_UNSIGNED_BYTE, page.Data<uint8_t>());
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
    std::vector<float> values;
    for (size_t t = 0; t < model.mesh.triangles.size(); ++t) {
      const lfm::PatchPlacement& place = model.placements[t];
      const int step = (place.flipped ? -1 : 1) * (place.edge_samples - 1);
      for (int c = 0; c < 3; ++c) {
        const Eigen::Vector3d p = pose * model.mesh.vertices[model.mesh.triangles[t][c]];
        const float u = (place.origin.x() + (c == 1 ? step : 0) + 0.5f) / page.width();
        const float v = (place.origin.y() + (c == 2 ? step : 0) + 0.5f) / page.height();
        values.insert(values.end(),
                      {static_cast<float>(2 * camera.fx / kWidth * p.x()),
                       static_cast<float>(-2 * camera.fy / kHeight * p.y()),
                       static_cast<float>(p.z() - 1), static_cast<float>(p.z()), u, v});
      }
    }
    corners_ = static_cast<int>(values.size() / 6);
    glBindVertexArray(array_.name());
    glBindBuffer(GL_ARRAY_BUFFER, buffer_.name());
    glBufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(values.size() * sizeof(float)),
                 values.data(), GL_STATIC_DRAW);
    glEnableVertexAttribArray(0);
    glEnableVertexAttribArray(1);
    glVertexAttribPointer(0, 4, GL_FLOAT, GL_FALSE, 24, nullptr);
    glVertexAttribPointer(1, 2, GL_FLOAT, GL_FALSE, 24, reinterpret_cast<const void*>(16));
    lfm::CheckGl("prepare the plain draw");
  }

  void Draw() const {
    glEnable(GL_DEPTH_TEST);
    glDepthFunc(GL_LESS);
    glClearColor(0, 0, 0, 1);
    glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
    glUseProgram(program_.name());
    glActiveTexture(GL_TEXTURE0);
    glBindTexture(GL_TEXTURE_2D, texture_.name());
    glBindVertexArray(array_.name());
    glDrawArrays(GL_TRIANGLES, 0, corners_);
    lfm::CheckGl("draw plainly");
  }

 private:
  static constexpr const char* kVertex =
      "#version 330 core\nin vec4 clip; in vec2 texcoord; out vec2 at;\n"
      "void main() { gl_Position = clip; at = texcoord; }\n";
  static constexpr const char* kFragment =
      "#version 330 core\nin vec2 at; out vec4 color; uniform sampler2D page;\n"
      "void main() { color = texture(page, at); }\n";
  lfm::GlObject program_, array_, buffer_, texture_;
  int corners_ = 0;
};

struct View {
  lfm::Camera camera;
  lfm::Pose pose;
};

// A little nearer than fits: about a third of the picture.
View ThirdOfThePicture(const lfm::LightFieldModel& model) {
  lfm::OrbitCamera orbit = lfm::FrameMesh(model.mesh, 0.5, static_cast<double>(kWidth) / kHeight);
  View view{lfm::PinholeCamera(orbit, kWidth, kHeight), lfm::CameraFromWorld(orbit)};
  for (int step = 0; step < 12; ++step) {
    const lfm::Image mask = lfm::RenderSilhouette(model.mesh, view.camera, view.pose);
    const auto covered = std::count(mask.Data<uint8_t>(), mask.Data<uint8_t>() + mask.size(), 255);
    const double share = static_cast<double>(covered) / (kWidth * kHeight);
    if (std::abs(share - 1.0 / 3) < 0.01) break;
    orbit = lfm::Zoom(orbit, std::clamp(std::sqrt(3 * share), 0.7, 1.4));
    view.pose = lfm::CameraFromWorld(orbit);
  }
  return view;
}

void Report(const std::string& file, int terms, lfm::BlockUse block_use) {
  const lfm::LightFieldModel model = lfm::ReadModel(file).model;
  const View view = ThirdOfThePicture(model);
  const lfm::GlRenderer gl(model, block_use);
  const PlainDraw plain(model, view.camera, view.pose);
  const lfm::GlFramebuffer framebuffer(kWidth, kHeight, 1);
  framebuffer.Bind();
  const auto draw = [&](lfm::ViewCoordinates where) {
    lfm::GlRenderOptions options;
    options.evaluation.terms = terms;
    options.view_coordinates = where;
    gl.Draw(view.camera, view.pose, options);
    glFinish();
  };
  struct Way {
    const char* name;
    std::function<void()> frame;
    std::vector<double> times = {};
    lfm::Image picture = {};
  };
  std::vector<Way> ways = {
      {"one texture", [&] { plain.Draw(), glFinish(); }},
      {"exact a pixel", [&] { draw(lfm::ViewCoordinates::kPerPixel); }},
      {"coordinates a vertex", [&] { draw(lfm::ViewCoordinates::kPerVertex); }},
      {"view maps at the corners", [&] { draw(lfm::ViewCoordinates::kMapsAtCorners); }}};
  for (Way& way : ways) {  // shaders are compiled
    way.frame();
    way.picture = framebuffer.Read();
  }
  for (int frame = 0; frame < kFrames; ++frame) {
    for (Way& way : ways) way.times.push_back(Milliseconds(way.frame));
  }
  const lfm::ReferenceRenderer reference(model);
  lfm::RenderOptions options;
  options.evaluation.terms = terms;
  lfm::Rendering exact;
  lfm::Image mask;
  std::vector<double> shaded, rays;
  const lfm::RayScene scene(model.mesh);
  for (int picture = 0; picture < kPictures; ++picture) {
    shaded.push_back(Milliseconds(
        [&] { exact = reference.Render(view.camera, view.pose, options, lfm::SilentProgress()); }));
    rays.push_back(
        Milliseconds([&] { mask = lfm::RenderSilhouette(scene, view.camera, view.pose); }));
  }
  std::printf("%s: %zu triangles, %d terms\n", file.c_str(), model.mesh.triangles.size(),
              std::min(terms, model.terms));
  const double base = Median(ways.front().times);
  for (const Way& way : ways) {
    const double time = Median(way.times);
    std::printf("| %s | %.2f ms | %.1f | %.1f frames/s | ", way.name, time, time / base,
                1000 / time);
    if (&way == &ways.front()) {
      std::printf("- | - |\n");
      continue;
    }
    std::printf("%.1f dB | %.1f dB |\n", lfm::CompareImages(way.picture, exact.color, mask).psnr_db,
                lfm::CompareImages(way.picture, ways[1].picture, mask).psnr_db);
  }
  std::printf("| reference renderer | %.1f ms | rays alone %.1f ms: %.0f %% of their rate |\n",
              Median(shaded), Median(rays), 100 * Median(rays) / Median(shaded));
}

// A row a number of terms.
void ReportByTerms(const std::string& file, lfm::BlockUse block_use) {
  const lfm::LightFieldModel model = lfm::ReadModel(file).model;
  const View view = ThirdOfThePicture(model);
  const lfm::GlRenderer gl(model, block_use);
  const lfm::GlFramebuffer framebuffer(kWidth, kHeight, 1);
  framebuffer.Bind();
  const std::vector<lfm::Passes> ways = {lfm::Passes::kOne, lfm::Passes::kPaper,
                                         lfm::Passes::kPaperUnsigned};
  std::printf("%s: %zu triangles, %.1f MB of maps\n", file.c_str(), model.mesh.triangles.size(),
              static_cast<double>(model.MapsBytes()) * 1e-6);
  std::vector<std::vector<std::vector<double>>> times(
      model.terms + 1, std::vector<std::vector<double>>(ways.size()));
  for (int frame = -1; frame < kFrames; ++frame) {  // shaders are compiled in the first
    for (int terms = 1; terms <= model.terms; ++terms) {
      for (size_t way = 0; way < ways.size(); ++way) {
        lfm::GlRenderOptions options;
        options.evaluation.terms = terms;
        options.passes = ways[way];
        const double time = Milliseconds([&] {
          gl.Draw(view.camera, view.pose, options);
          glFinish();
        });
        if (frame >= 0) times[terms][way].push_back(time);
      }
    }
  }
  for (int terms = 1; terms <= model.terms; ++terms) {
    std::printf("| %d |", terms);
    for (size_t way = 0; way < ways.size(); ++way) {
      lfm::GlRenderOptions options;
      options.evaluation.terms = terms;
      options.passes = ways[way];
      const double time = Median(times[terms][way]);
      std::printf(" %d: %.1f ms, %.1f frames/s |", gl.PassCount(options), time, 1000 / time);
    }
    std::printf("\n");
  }
}

// From a little way above, the whole scene in the picture.
void ReportScene(const std::string& file, lfm::BlockUse block_use) {
  const lfm::Scene scene = lfm::ReadScene(lfm::ReadSceneFile(file), lfm::SilentProgress());
  const lfm::TriangleMesh mesh = lfm::SceneMesh(scene);
  const lfm::OrbitCamera orbit = lfm::FrameMesh(mesh, 0.5, static_cast<double>(kWidth) / kHeight);
  const lfm::Camera camera = lfm::PinholeCamera(orbit, kWidth, kHeight);
  const lfm::Pose pose = lfm::CameraFromWorld(orbit);
  const lfm::GlScene gl(scene, block_use);
  const lfm::ReferenceRenderer reference(scene);
  const lfm::GlFramebuffer framebuffer(kWidth, kHeight, 1);
  framebuffer.Bind();
  std::printf("%s: %zu models, %zu triangles\n", file.c_str(), scene.size(), mesh.triangles.size());
  const auto report = [](const char* name, const std::function<void()>& frame, int frames) {
    frame();
    std::vector<double> times;
    for (int i = 0; i < frames; ++i) times.push_back(Milliseconds(frame));
    std::printf("| %s | %.1f ms | %.1f frames/s |\n", name, Median(times), 1000 / Median(times));
  };
  for (const int terms : {1, 1 << 20}) {
    std::printf("| %s terms | | |\n", terms == 1 ? "1" : "all");
    for (const auto& [name, where] :
         {std::pair{"OpenGL, exact a pixel", lfm::ViewCoordinates::kPerPixel},
          {"OpenGL, view maps at the corners", lfm::ViewCoordinates::kMapsAtCorners}}) {
      lfm::GlRenderOptions options;
      options.evaluation.terms = terms;
      options.view_coordinates = where;
      report(
          name, [&] { gl.Draw(camera, pose, options), glFinish(); }, kFrames);
    }
    lfm::RenderOptions options;
    options.evaluation.terms = terms;
    report(
        "reference renderer",
        [&] { (void)reference.Render(camera, pose, options, lfm::SilentProgress()); }, kPictures);
  }
}

}  // namespace

int main(int argc, char** argv) {
  int terms = 3;
  lfm::BlockUse block_use = lfm::BlockUse::kAutomatic;
  bool by_terms = false;
  std::vector<std::string> files;
  for (int i = 1; i < argc; ++i) {
    if (std::strcmp(argv[i], "--terms") == 0 && i + 1 < argc) {
      terms = std::atoi(argv[++i]);
    } else if (std::strcmp(argv[i], "--blocks-as-they-are") == 0) {
      block_use = lfm::BlockUse::kAsTheyAre;
    } else if (std::strcmp(argv[i], "--by-terms") == 0) {
      by_terms = true;
    } else {
      files.emplace_back(argv[i]);
    }
  }
  if (files.empty()) {
    std::fprintf(
        stderr,
        "lfm-bench-viewer MODEL|SCENE... [--terms K] [--blocks-as-they-are] [--by-terms]\n");
    return 2;
  }
  try {
    const lfm::EglContext context;
    if (by_terms) {
      std::printf(
          "%s\n| terms | one pass | the paper's passes | unsigned ones |\n|---|---|---|---|\n",
          glGetString(GL_RENDERER));
      for (const std::string& file : files) ReportByTerms(file, block_use);
      return 0;
    }
    std::printf(
        "%s\n| way | a frame | times one texture | rate | against the reference | against "
        "exact |\n|---|---|---|---|---|---|\n",
        glGetString(GL_RENDERER));
    for (const std::string& file : files) {
      if (lfm::IsSceneFile(file)) {
        ReportScene(file, block_use);
      } else {
        Report(file, terms, block_use);
      }
    }
  } catch (const lfm::Error& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
  return 0;
}
