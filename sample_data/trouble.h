// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/options.h"

namespace lfm {

/// What a photograph's file holds.
enum class PhotoFormat {
  kPng8,   ///< 8-bit sRGB
  kPng16,  ///< 16-bit linear; the manifest says so
  kExr,    ///< 32-bit float, linear; noise below zero is kept
  kJpeg,   ///< 8-bit sRGB
};

/// What comes between the camera and the platform.
enum class OccluderKind { kStick, kHand };

/// What goes wrong when photographs are taken. Defaults: nothing but the sensor's noise. The
/// noise-free photographs of the ground truth are free of all of it but the lens's distortion.
struct PhotoTrouble {
  double distortion = 1;
  double exposure_jitter_stops = 0, white_balance_jitter_percent = 0;
  double vignetting_stops = 0;
  double motion_blur_mm = 0;
  double aperture_mm = 0, focus_error_mm = 0;
  int blur_samples = 16;
  double occluded_share = 0, half_frame_share = 0;
  OccluderKind occluder = OccluderKind::kStick;
  PhotoFormat format = PhotoFormat::kPng8;

  void Declare(OptionVisitor& v) {
    v.Number(
        {"distortion",
         "The lens's distortion, in units of the usual, which moves a corner of the picture by "
         "1.3 % of its diagonal (16 px of 960 x 720).",
         "", -3, 3},
        distortion);
    v.Number({"exposure-jitter", "Standard deviation of the exposure between photographs.", "stops",
              0, 3},
             exposure_jitter_stops);
    v.Number({"white-balance-jitter",
              "Standard deviation of the gains of red and blue between photographs.", "%", 0, 50},
             white_balance_jitter_percent);
    v.Number(
        {"vignetting", "Light lost in the corners; falls as cos^4 from the middle.", "stops", 0, 4},
        vignetting_stops);
    v.Number({"motion-blur", "Way of the camera during the exposure, sideways.", "mm", 0, 20},
             motion_blur_mm);
    v.Number({"aperture", "Diameter of the lens, focused at the subject's middle; 0: a pinhole.",
              "mm", 0, 50},
             aperture_mm);
    v.Number({"focus-error", "How far behind the subject's middle the lens is focused.", "mm", -150,
              1000},
             focus_error_mm);
    v.Integer({"blur-samples", "Pictures that motion blur and defocus average.", "", 2, 256},
              blur_samples);
    v.Number({"occluded-share", "Share of the training photographs with something in the way.", "",
              0, 1},
             occluded_share);
    v.Enumeration({"occluder", "What is in the way."}, {"stick", "hand"}, occluder);
    v.Number(
        {"half-frame-share",
         "Share of the training photographs with the platform half out of the picture.", "", 0, 1},
        half_frame_share);
    v.Enumeration({"photo-format", "Format of the photographs; 16-bit PNG and EXR are linear."},
                  {"png8", "png16", "exr", "jpeg"}, format);
  }
};

/// Whether the sensor makes noise.
enum class SensorNoise { kAuto, kOn, kOff };

/// The sensor of both cameras.
struct SensorTrouble {
  SensorNoise noise = SensorNoise::kAuto;
  double full_well_electrons = 20000, read_noise_electrons = 5;

  void Declare(OptionVisitor& v) {
    v.Enumeration({"sensor-noise",
                   "Shot and read noise; auto: off at --quality reference, unless --full-well or "
                   "--read-noise is given; else on. Files of 8 and 16 bits round all the same."},
                  {"auto", "on", "off"}, noise);
    v.Number({"full-well", "Electrons of a saturated pixel; fewer make more shot noise.",
              "electrons", 100, 1e12},
             full_well_electrons);
    v.Number({"read-noise", "Standard deviation of the sensor's read noise.", "electrons", 0, 1e4},
             read_noise_electrons);
  }
};

/// How the real platform departs from board.json and from a good turntable.
struct PlatformTrouble {
  double tag_error_mm = 0, print_scale_percent = 0, plate_sag_mm = 0;
  double axis_tilt_deg = 0, wobble_mm = 0, frame_wobble_mm = 0;

  void Declare(OptionVisitor& v) {
    v.Number(
        {"tag-error", "Standard deviation of a printed tag's place, in x and in y.", "mm", 0, 1},
        tag_error_mm);
    v.Number({"print-scale", "How much larger than stated the print is.", "%", -1.5, 1.5},
             print_scale_percent);
    v.Number({"plate-sag", "How far the plate's left and right edges hang below its middle.", "mm",
              -4, 4},
             plate_sag_mm);
    v.Number({"axis-tilt", "Angle between the turntable's axis and the platform's normal.", "deg",
              0, 10},
             axis_tilt_deg);
    v.Number({"wobble", "Standard deviation of the platform's place at a scan, and at its rim.",
              "mm", 0, 5},
             wobble_mm);
    v.Number({"frame-wobble",
              "The same from frame to frame within a scan, about the scan's place (each frame is "
              "traced alone: slow).",
              "mm", 0, 5},
             frame_wobble_mm);
  }
};

/// What goes wrong when scans are taken.
struct ScanTrouble {
  double projector_gamma = 1;
  double projector_defocus_px = 0;
  double ambient_light = 0.015;
  double exposure_factor = 1;
  double crosstalk_percent = 0;
  double subsurface_mm = 0;

  void Declare(OptionVisitor& v) {
    v.Number(
        {"projector-gamma", "The projector shows a pattern's value to this power.", "", 0.2, 5},
        projector_gamma);
    v.Number(
        {"projector-defocus", "Blur of the projector's picture (Gaussian, sigma).", "px", 0, 50},
        projector_defocus_px);
    v.Number(
        {"ambient-light", "What white paint shows in the dark (1: the sensor is full).", "", 0, 1},
        ambient_light);
    v.Number(
        {"scan-exposure", "Exposure of the scans; above 1.2 white paint saturates.", "", 0.01, 100},
        exposure_factor);
    v.Number(
        {"crosstalk", "Light that leaks from each of the other two colours of a projected picture.",
         "%", 0, 33},
        crosstalk_percent);
    v.Number(
        {"subsurface", "How far light spreads in the white paint (Gaussian, sigma).", "mm", 0, 5},
        subsurface_mm);
  }
};

/// Every knob of trouble. With defaults a capture has the bytes that it would have without them.
struct Trouble {
  PhotoTrouble photo;
  SensorTrouble sensor;
  PlatformTrouble platform;
  ScanTrouble scan;

  void Declare(OptionVisitor& v) {
    photo.Declare(v);
    sensor.Declare(v);
    platform.Declare(v);
    scan.Declare(v);
  }
};

}  // namespace lfm
