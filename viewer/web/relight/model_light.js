// SPDX-License-Identifier: BSD-3-Clause
// Light as a model's columns want it: a number a direction, `light[channel]`.
import { ModelError } from '../src/model_error.js';
import { kCubeTexels } from './lfr_file.js';
import { lightCubeOf, solidAngleOf, texelOf, texelsRound } from './light_cube.js';
import { nearestFinder } from './nearest_direction.js';
import { PointLight } from './point_light.js';
import {
  directionOfMap, kMapHeight, kMapWidth, mapOfDirection, solidAngleOfRow,
} from './surroundings.js';
import { angleBetween, dot, vectorAt } from './vectors.js';

const kLuminance = [0.2126, 0.7152, 0.0722];

export class ModelLight {
  /** `upright`: the frame that surroundings stand in (view_frame.js). */
  constructor(model, upright) {
    this.model = model;
    this.upright = upright;
    this.count = model.directions.length / 3;
    this.cube = model.kind === kCubeTexels ? lightCubeOf(model.directions) : null;
    if (model.kind === kCubeTexels && this.cube === null) {
      throw new ModelError("the model's directions are not those of a cube map; encode it again");
    }
    this.point = this.cube === null ? new PointLight(model.directions) : null;
    this.cells = null; // of surroundings, once they are asked for
  }

  /** White parallel light of unit irradiance from `direction`. */
  parallel(direction) {
    const light = new Float64Array(this.count);
    if (this.cube === null) {
      for (const { index, share } of this.point.sharesOf(direction)) light[index] += share;
    } else {
      for (const { index, share } of texelsRound(this.cube, direction)) {
        light[index] += share / solidAngleOf(this.cube, index);
      }
    }
    return Array(this.model.channels).fill(light);
  }

  /**
   * Of a map (surroundings.js), turned by `degrees` (lights on the viewer's side move to the right):
   * the irradiance from each direction's cell, or the mean radiance of each texel. From where the
   * model knows no light, none comes.
   */
  surroundings(map, degrees) {
    this.cells ??= this.makeCells();
    const light = [0, 1, 2].map(() => new Float64Array(this.count));
    const columns = Array.from({ length: kMapWidth }, (_, x) =>
      columnsAt(x + degrees / 360 * kMapWidth));
    const { owner } = this.cells, [red, green, blue] = light;
    for (let y = 0, texel = 0; y < kMapHeight; ++y) {
      const solidAngle = solidAngleOfRow(y), row = 3 * kMapWidth * y;
      for (let x = 0; x < kMapWidth; ++x, ++texel) {
        const own = owner[texel];
        if (own < 0) continue;
        const { left, right, share } = columns[x];
        const a = row + 3 * left, b = row + 3 * right;
        const toLeft = solidAngle * (1 - share), toRight = solidAngle * share;
        red[own] += toLeft * map[a] + toRight * map[b];
        green[own] += toLeft * map[a + 1] + toRight * map[b + 1];
        blue[own] += toLeft * map[a + 2] + toRight * map[b + 2];
      }
    }
    if (this.cube !== null) this.averageTexels(light, map, degrees);
    return this.inChannels(light);
  }

  /** What owns each texel of a map: the nearest direction, none beyond the rim of a dome. */
  makeCells() {
    const find = this.cube === null ? this.cellFinder()
      : (direction) => texelOf(this.cube, direction);
    const owner = new Int32Array(kMapWidth * kMapHeight);
    const solidAngles = new Float64Array(this.count);
    for (let i = 0; i < owner.length; ++i) {
      const x = i % kMapWidth, y = Math.floor(i / kMapWidth);
      const [r, u, f] = directionOfMap((x + 0.5) / kMapWidth, (y + 0.5) / kMapHeight);
      const { right, up, front } = this.upright;
      owner[i] = find(right.map((value, k) => r * value + u * up[k] + f * front[k]));
      if (owner[i] >= 0) solidAngles[owner[i]] += solidAngleOfRow(y);
    }
    return { owner, solidAngles };
  }

  // The nearest direction; -1 where none reaches.
  cellFinder() {
    const { model: { directions }, point } = this, nearest = nearestFinder(directions);
    return (direction) => {
      const index = nearest(direction);
      const angle = angleBetween(vectorAt(directions, index), direction);
      return point.reaches(direction, angle) ? index : -1;
    };
  }

  averageTexels(light, map, degrees) {
    const { right, up, front } = this.upright;
    for (let i = 0; i < this.count; ++i) {
      const solidAngle = this.cells.solidAngles[i];
      const direction = vectorAt(this.model.directions, i);
      const color = solidAngle > 0 ? null
        : radianceAt(map, degrees, [right, up, front].map((axis) => dot(axis, direction)));
      for (let c = 0; c < 3; ++c) {
        light[c][i] = solidAngle > 0 ? light[c][i] / solidAngle : color[c];
      }
    }
  }

  inChannels(light) {
    if (this.model.channels === 3) return light;
    return [light[0].map((_, i) => kLuminance.reduce((sum, k, c) => sum + k * light[c][i], 0))];
  }
}

// The columns left and right of `x`, which may lie beyond the picture: it closes.
function columnsAt(x) {
  const low = Math.floor(x), wrap = (i) => (i % kMapWidth + kMapWidth) % kMapWidth;
  return { left: wrap(low), right: wrap(low + 1), share: x - low };
}

/** [r, g, b] of a map turned by `degrees`, in a direction of the upright frame. */
export const radianceAt = (map, degrees, direction) =>
  radianceAtMap(map, degrees, mapOfDirection(direction));

/** The same, at [u, v] of a map that is not turned. */
export function radianceAtMap(map, degrees, [u, v]) {
  const y = Math.min(kMapHeight - 1, Math.floor(v * kMapHeight));
  const { left, right, share } = columnsAt((u + degrees / 360) * kMapWidth - 0.5);
  const a = 3 * (y * kMapWidth + left), b = 3 * (y * kMapWidth + right);
  return [(1 - share) * map[a] + share * map[b], (1 - share) * map[a + 1] + share * map[b + 1],
          (1 - share) * map[a + 2] + share * map[b + 2]];
}
