// SPDX-License-Identifier: BSD-3-Clause
// Where a model stands in a scene (viewer/scene.h): p_world = position + quaternion * (scale *
// p_model); mm, quaternions x, y, z, w of unit length, scales positive.

export const kWhereItIs = Object.freeze({
  position: Object.freeze([0, 0, 0]), quaternion: Object.freeze([0, 0, 0, 1]), scale: 1,
});

/** Puts an Object3D of three.js there. */
export function stand(object, { position, quaternion, scale }) {
  object.position.set(...position);
  object.quaternion.set(...quaternion);
  object.scale.setScalar(scale);
}

/** A function (x, y, z, out) that writes into `out` where the model's point is in the world. */
export function worldFromModel({ position, quaternion: [x, y, z, w], scale }) {
  const rows = [
    [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
    [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
    [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
  ];
  return (a, b, c, out) => {
    for (let i = 0; i < 3; ++i) {
      out[i] = scale * (rows[i][0] * a + rows[i][1] * b + rows[i][2] * c) + position[i];
    }
  };
}
