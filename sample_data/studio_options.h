// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "core/options.h"
#include "sample_data/sensor.h"
#include "sample_data/trouble.h"
#include "scan/patterns.h"

namespace lfm {

/// How many samples the light of a scene gets.
enum class RenderQuality { kDraft, kDefault, kReference };

/// What the studio makes. The same options give the same capture, byte for byte.
struct StudioOptions {
  std::string scene = "bust";  ///< built in, or a scene file; `mesh` replaces it
  std::string mesh;
  double mesh_height_mm = 120;
  std::string board;  ///< a board file; empty: DefaultBoard
  int seed = 1;
  RenderQuality quality = RenderQuality::kDefault;
  int test_light = 1;
  int transport_channels = 1;
  bool tiny = false;
  int photos = 120, test_photos = 16;
  int photo_width = 960, photo_height = 720;
  int scans = 18, placements = 5;
  int scan_width = 640, scan_height = 480;
  int projector_width = 1024, projector_height = 768;
  PatternScheme patterns = PatternScheme::kGrayPhase;
  int phase_steps = 8;
  int stripe_width_px = 12, stripe_step_px = 4;
  double rig_low_deg = 15, rig_high_deg = 48;
  double edge_mm = 0.55;
  int jpeg_quality = 0;
  Trouble trouble;

  /// The samples of this quality where the default has `usual`.
  int SamplesPerPixel(int usual) const {
    if (quality == RenderQuality::kDraft) return usual / 4 > 0 ? usual / 4 : 1;
    return quality == RenderQuality::kReference ? 16 * usual : usual;
  }

  void Declare(OptionVisitor& v) {
    v.Text({"scene", "What is recorded: a scene that is built in, or a scene file (JSON)."}, scene);
    v.Enumeration(
        {"quality",
         "Samples of light: a quarter, the usual, or 16 times as many, a sensor without noise "
         "(--sensor-noise) and no limit to the light of one path."},
        {"draft", "default", "reference"}, quality);
    v.Integer({"test-light",
               "Times as many samples of light for the held-out photographs of scenes whose paths "
               "are traced: so that they measure a model and not their own grain.",
               "", 1, 256},
              test_light);
    v.Integer({"transport-channels", "Colour channels of a transport matrix: 1 (their mean) or 3.",
               "", 1, 3},
              transport_channels);
    v.Text({"mesh",
            "A PLY or OBJ mesh to stand on the platform, painted, instead of the scene's object. "
            "Colours: its vertices', or its materials' and their pictures."},
           mesh);
    v.Number({"mesh-height", "Scale --mesh to this height.", "mm", 1, 160}, mesh_height_mm);
    v.Text({"board", "A board file (of lfm-board): the platform, instead of the usual one."},
           board);
    v.Integer({"seed", "Seed of hand-held jitter, paint and noise.", "", 0, 1e9}, seed);
    v.Flag({"tiny",
            "A small, quick capture: sizes and counts that are not given take their tiny values."},
           tiny);
    v.Integer({"photos", "Number of photographs.", "", 1, 10000}, photos);
    v.Integer({"test-photos", "How many of them are held out.", "", 0, 10000}, test_photos);
    v.Integer({"photo-width", "Width of a photograph.", "px", 16, 16384}, photo_width);
    v.Integer({"photo-height", "Height of a photograph.", "px", 16, 16384}, photo_height);
    v.Integer({"scans", "Number of scans.", "", 0, 1000}, scans);
    v.Integer({"placements", "Number of placements of the empty platform.", "", 0, 1000},
              placements);
    v.Integer({"scan-width", "Width of a scan picture.", "px", 16, 16384}, scan_width);
    v.Integer({"scan-height", "Height of a scan picture.", "px", 16, 16384}, scan_height);
    v.Integer({"projector-width", "Width of the projector's picture.", "px", 16, 8192},
              projector_width);
    v.Integer({"projector-height", "Height of the projector's picture.", "px", 16, 8192},
              projector_height);
    v.Enumeration({"patterns",
                   "What scans project: Gray code and phase shift, Gray code alone, phase shifts "
                   "of several periods, or a moving stripe."},
                  {"gray-phase", "gray", "multi-phase", "stripe"}, patterns);
    v.Integer({"phase-steps", "Steps of every phase shift.", "", 3, 256}, phase_steps);
    v.Integer({"stripe-width", "Width of the moving stripe at half its height.", "px", 1, 4096},
              stripe_width_px);
    v.Integer({"stripe-step", "Way of the stripe from one frame to the next.", "px", 1, 4096},
              stripe_step_px);
    v.Number(
        {"edge", "Length of the object's edges; light is baked at its vertices.", "mm", 0.1, 10},
        edge_mm);
    v.Integer({"jpeg-quality", "Write JPEG pictures of this quality instead of PNG; 0 means PNG.",
               "", 0, 100},
              jpeg_quality);
    trouble.Declare(v);
  }
};

/// The sensor of these options: without noise (an infinite well) when that is switched off, or left
/// to the program at reference quality with well and read noise at their defaults.
Sensor MakeSensor(const StudioOptions& options);

/// With `tiny` set, every size and count still at its default takes the tiny value: 20 photographs
/// (12 of a scene whose light is traced) of 320 x 240, 2 of them test, 3 scans and 3 placements of
/// 240 x 180, a projector of 256 x 192 with 4 phase steps, the rig not below 36 degrees (tags would
/// be too flat to read), a coarse object. Without it, the options as they are.
StudioOptions ResolveTiny(const StudioOptions& options);

}  // namespace lfm
