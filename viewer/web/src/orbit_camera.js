// SPDX-License-Identifier: BSD-3-Clause
// A camera that circles a target, z up, with the limits of the desktop viewer
// (viewer/orbit_camera.h). Angles in radians, lengths in mm. Functions return changed copies;
// changes that are not finite are ignored.

const kFramingMargin = 0.08;
const kMaxElevation = 89 * Math.PI / 180;

const clamp = (value, low, high) => Math.min(Math.max(value, low), high);

/**
 * A camera whose picture holds all of `bounds` (bounds.js) with a margin; aspect = width / height.
 * The eye comes as near as the smallest part of a scene wants it: `bounds.closest`.
 */
export function frame(bounds, verticalFov, aspect) {
  const halfTangent = Math.tan(verticalFov / 2) * Math.min(1, aspect) * (1 - kFramingMargin);
  const distance = bounds.radius * Math.sqrt(1 + 1 / (halfTangent * halfTangent));
  return {
    target: [...bounds.center],
    azimuth: 300 * Math.PI / 180,
    elevation: 25 * Math.PI / 180,
    distance,
    verticalFov,
    center: bounds.center,
    radius: bounds.radius,
    minDistance: Math.min(1.05 * (bounds.closest ?? bounds.radius), distance),
    maxDistance: Math.max(50 * bounds.radius, 2 * distance),
  };
}

/** The camera where it is, within the limits of `framed`, one that frames other bounds. */
export function withLimitsOf(camera, { center, radius, minDistance, maxDistance }) {
  return { ...camera, center, radius, minDistance, maxDistance };
}

export function orbit(camera, azimuthChange, elevationChange) {
  const turned = { ...camera };
  if (Number.isFinite(azimuthChange)) {
    const azimuth = (camera.azimuth + azimuthChange) % (2 * Math.PI);
    turned.azimuth = azimuth < 0 ? azimuth + 2 * Math.PI : azimuth;
  }
  if (Number.isFinite(elevationChange)) {
    turned.elevation = clamp(camera.elevation + elevationChange, -kMaxElevation, kMaxElevation);
  }
  return turned;
}

export function zoom(camera, factor) {
  if (!(Number.isFinite(factor) && factor > 0)) return camera;
  const distance = clamp(camera.distance * factor, camera.minDistance, camera.maxDistance);
  return { ...camera, distance };
}

/** Whatever distance, honoured as given. */
export function withDistance(camera, distance) {
  if (!(Number.isFinite(distance) && distance > 0)) return camera;
  return {
    ...camera,
    distance,
    minDistance: Math.min(camera.minDistance, distance),
    maxDistance: Math.max(camera.maxDistance, distance),
  };
}

/** The target moved to `point`, which stays within the object's sphere. */
export function lookAt(camera, point) {
  const offset = point.map((value, i) => value - camera.center[i]);
  const length = Math.hypot(...offset);
  if (!Number.isFinite(length)) return camera;
  const scale = length > camera.radius ? camera.radius / length : 1;
  return { ...camera, target: camera.center.map((value, i) => value + scale * offset[i]) };
}

/** Moves the target so that it follows the pointer by x, y pixels in a picture of `height`. */
export function pan(camera, x, y, height) {
  if (!Number.isFinite(x) || !Number.isFinite(y) || !(height >= 1)) return camera;
  const scale = 2 * camera.distance * Math.tan(camera.verticalFov / 2) / height;
  const sinA = Math.sin(camera.azimuth), cosA = Math.cos(camera.azimuth);
  const sinE = Math.sin(camera.elevation), cosE = Math.cos(camera.elevation);
  const right = [-sinA, cosA, 0], down = [sinE * cosA, sinE * sinA, -cosE];
  const move = (value, i) => value - scale * (x * right[i] + y * down[i]);
  return lookAt(camera, camera.target.map(move));
}

/** Where the eye is, mm. */
export function eyeOf({ target, azimuth, elevation, distance }) {
  const flat = Math.cos(elevation);
  return [
    target[0] + distance * flat * Math.cos(azimuth),
    target[1] + distance * flat * Math.sin(azimuth),
    target[2] + distance * Math.sin(elevation),
  ];
}
