// SPDX-License-Identifier: BSD-3-Clause
// Where light comes from, as the page for relighting works it out: one light, surroundings, frames.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { lightCubeOf, solidAngleOf, texelOf } from '../../viewer/web/relight/light_cube.js';
import { madeTitles, makeSurroundings } from '../../viewer/web/relight/made_surroundings.js';
import { ModelLight, radianceAt } from '../../viewer/web/relight/model_light.js';
import { nearestFinder } from '../../viewer/web/relight/nearest_direction.js';
import { PointLight } from '../../viewer/web/relight/point_light.js';
import { readRadiancePicture } from '../../viewer/web/relight/radiance_picture.js';
import {
  directionOfMap, kMapHeight, kMapWidth, mapOfDirection, readMap, solidAngleOfRow,
} from '../../viewer/web/relight/surroundings.js';
import { angleBetween, cross, dot } from '../../viewer/web/relight/vectors.js';
import {
  anglesOf, directionAt, turned, turnOfWorld, uprightFrameOf, viewFrameOf,
} from '../../viewer/web/relight/view_frame.js';
import { ModelError } from '../../viewer/web/src/model_error.js';

const kVector_abs = 1e-12;
const kIntegral_rel = 1e-6;

const near = (a, b, tolerance = kVector_abs) => {
  a.forEach((value, i) => assert.ok(Math.abs(value - b[i]) <= tolerance, `${a} instead of ${b}`));
};

/** `count` directions over the sphere, or over its upper half. */
function spiral(count, leastZ = -1) {
  return Array.from({ length: count }, (_, i) => {
    const z = 1 - (1 - leastZ) * (i + 0.5) / count, angle = i * Math.PI * (3 - Math.sqrt(5));
    return [Math.sqrt(1 - z * z) * Math.cos(angle), Math.sqrt(1 - z * z) * Math.sin(angle), z];
  });
}

function cubeDirections(n) {
  const faces = [0, 1, 2, 3, 4, 5].map((f) => {
    const normal = [0, 0, 0], right = [0, 0, 0];
    normal[f >> 1] = f % 2 === 0 ? 1 : -1;
    right[((f >> 1) + 1) % 3] = 1;
    return { normal, right, down: cross(normal, right) };
  });
  return faces.flatMap(({ normal, right, down }) => Array.from({ length: n * n }, (_, i) => {
    const a = (2 * (i % n) + 1) / n - 1, b = (2 * Math.floor(i / n) + 1) / n - 1;
    const v = normal.map((value, k) => value + a * right[k] + b * down[k]);
    return v.map((value) => value / Math.hypot(...v));
  }));
}

function sharesOf(directions, direction) {
  const found = new PointLight(Float64Array.from(directions.flat())).sharesOf(direction);
  assert.ok(found.every(({ share }) => share > 0), JSON.stringify(found));
  near([found.reduce((sum, { share }) => sum + share, 0)], [1]);
  return found;
}

const indicesOf = (found) => found.map(({ index }) => index).sort((a, b) => a - b);

test('PointLight: a direction of the model is itself', () => {
  for (const directions of [spiral(100), spiral(60, 0), cubeDirections(3)]) {
    const light = new PointLight(Float64Array.from(directions.flat()));
    directions.forEach((direction, i) => {
      const own = light.sharesOf(direction).find(({ index }) => index === i);
      assert.ok(own.share > 1 - 1e-6, `direction ${i}: ${own?.share}`);
    });
  }
});

test('PointLight: three surrounding directions, in shares that point back', () => {
  const directions = spiral(150), light = new PointLight(Float64Array.from(directions.flat()));
  for (const direction of spiral(999)) {
    const found = light.sharesOf(direction);
    assert.ok(found.length <= 3);
    const mean = [0, 1, 2].map((k) =>
      found.reduce((sum, { index, share }) => sum + share * directions[index][k], 0));
    assert.ok(angleBetween(mean, direction) < 1e-6);
    for (const { index } of found) assert.ok(angleBetween(directions[index], direction) < 0.5);
  }
});

test('PointLight: the hull of a sphere closes, however regular', () => {
  for (const directions of [spiral(4), spiral(253), cubeDirections(2), cubeDirections(5)]) {
    const light = new PointLight(Float64Array.from(directions.flat()));
    assert.equal(light.triangles.length, 2 * directions.length - 4); // Euler
    assert.equal(light.rim.length, 0);
    for (const corners of light.triangles) {
      const [a, b, c] = corners.map((i) => directions[i]);
      const normal = cross(b.map((v, k) => v - a[k]), c.map((v, k) => v - a[k]));
      for (const other of directions) {
        assert.ok(dot(normal, other) - dot(normal, a) <= 1e-9, 'Delaunay: nothing lies outside');
      }
    }
  }
});

test('PointLight: shares are continuous, to the rim of a dome and beyond', () => {
  const light = new PointLight(Float64Array.from(spiral(253, 0).flat()));
  const at = (angle, round) => [Math.sin(angle) * Math.cos(round), Math.sin(angle) * Math.sin(round),
                                Math.cos(angle)];
  for (const round of [0.1, 1.7, 4]) {
    let before = null;
    for (let angle = 0; angle < 1.9; angle += 0.001) {
      const now = new Map(light.sharesOf(at(angle, round)).map(({ index, share }) => [index, share]));
      if (before !== null) {
        const keys = new Set([...before.keys(), ...now.keys()]);
        const change = [...keys].reduce((sum, k) =>
          sum + Math.abs((now.get(k) ?? 0) - (before.get(k) ?? 0)), 0);
        assert.ok(change < 0.15, `${angle}: ${change}`);
      }
      before = now;
    }
  }
});

test('PointLight: below a dome the rim on that side gives light', () => {
  const directions = spiral(253, 0), light = new PointLight(Float64Array.from(directions.flat()));
  for (const direction of [[0.8, 0, -0.6], [-0.6, 0.6, -Math.sqrt(0.28)]]) {
    for (const { index } of light.sharesOf(direction)) {
      const [x, y, z] = directions[index];
      assert.ok(z < 0.25 && x * direction[0] + y * direction[1] > 0.6, `${[x, y, z]}`);
    }
  }
  assert.ok(light.reach < 0.2, `${light.reach}`);
  for (const [direction, angle, expected] of [[[0, 0, 1], 1, true], [[0, 0, -1], 1, false],
                                              [[0, 0.6, -0.8], 0.01, true]]) {
    assert.equal(light.reaches(direction, angle), expected, `${direction}`);
  }
});

test('PointLight: few directions, the same twice, a ring, a line', () => {
  assert.deepEqual(sharesOf([[0, 0, 1]], [1, 0, 0]), [{ index: 0, share: 1 }]);
  assert.deepEqual(sharesOf([[0, 0, 1], [0, 0, 1]], [1, 0, 0]),
                   [{ index: 0, share: 1 }]);
  const two = sharesOf([[0, 0, 1], [1, 0, 0]], [Math.SQRT1_2, 0, Math.SQRT1_2]);
  near(two.map(({ share }) => share), [0.5, 0.5]);
  assert.deepEqual(sharesOf([[0, 0, 1], [1, 0, 0]], [-0.6, 0, 0.8]), [{ index: 0, share: 1 }]);
  assert.deepEqual(indicesOf(sharesOf([[0, 0, 1], [0, 0, -1]], [0.6, 0, 0.8])), [0]);
  const third = 1 / Math.sqrt(3);
  near(sharesOf([[1, 0, 0], [0, 1, 0], [0, 0, 1]], [third, third, third])
    .map(({ share }) => share), [1 / 3, 1 / 3, 1 / 3]);
  const ring = Array.from({ length: 12 }, (_, i) => [0.6 * Math.cos(i * Math.PI / 6),
                                                    0.6 * Math.sin(i * Math.PI / 6), 0.8]);
  assert.deepEqual(indicesOf(sharesOf(ring, [Math.cos(0.2), Math.sin(0.2), 0])), [0, 1]);
  sharesOf(ring, [0, 0, 1]);
  const onCircle = Array.from({ length: 5 }, (_, i) => [Math.cos(i / 4), Math.sin(i / 4), 0]);
  assert.deepEqual(indicesOf(sharesOf(onCircle, [Math.cos(0.3), Math.sin(0.3), 0])), [1, 2]);
});

test('nearestFinder: is the brute search, the first of equal ones', () => {
  const directions = [...spiral(300), ...spiral(300).slice(0, 20)];
  const flat = Float64Array.from(directions.flat());
  const find = nearestFinder(flat);
  for (const direction of [...spiral(2000), ...directions]) {
    let best = 0;
    directions.forEach((other, i) => {
      const square = (d) => d.reduce((sum, v, k) => sum + (v - direction[k]) ** 2, 0);
      if (square(other) < square(directions[best])) best = i;
    });
    assert.equal(find(direction), best);
  }
});

test('lightCubeOf: finds every texel, whatever the order of faces', () => {
  for (const n of [1, 2, 5, 16]) {
    const directions = cubeDirections(n), cube = lightCubeOf(Float64Array.from(directions.flat()));
    let sum = 0;
    directions.forEach((direction, i) => {
      assert.equal(texelOf(cube, direction), i);
      sum += solidAngleOf(cube, i);
    });
    near([sum], [4 * Math.PI], 1e-9);
  }
  assert.equal(lightCubeOf(Float64Array.from(spiral(54).flat())), null);
  assert.equal(lightCubeOf(Float64Array.from(spiral(53).flat())), null);
});

const kRtiFrame = uprightFrameOf(viewFrameOf(''));
const modelOf = (directions, kind = 0, channels = 3) =>
  ({ directions: Float64Array.from(directions.flat()), kind, channels });

test('surroundings: constant radiance is 4 pi of irradiance, or its own in texels', () => {
  const map = new Float32Array(3 * kMapWidth * kMapHeight).map((_, i) => [1, 2, 4][i % 3]);
  for (const directions of [spiral(100), spiral(7000)]) {
    const light = new ModelLight(modelOf(directions), kRtiFrame).surroundings(map, 33);
    const sums = light.map((own) => own.reduce((a, b) => a + b, 0) / (4 * Math.PI));
    near(sums, [1, 2, 4], 4 * kIntegral_rel);
  }
  const [[half]] = new ModelLight(modelOf([[0, 0, 1]]), kRtiFrame).surroundings(map, 33);
  near([half / (2 * Math.PI)], [1], kIntegral_rel); // one light tells of its side
  for (const n of [1, 8, 80]) {
    const light = new ModelLight(modelOf(cubeDirections(n), 1), kRtiFrame).surroundings(map, -10);
    light.forEach((own, c) => own.forEach((value) =>
      near([value], [[1, 2, 4][c]], 4 * kIntegral_rel)));
  }
  const gray = new ModelLight(modelOf(spiral(10), 0, 1), kRtiFrame).surroundings(map, 0);
  near([gray[0].reduce((a, b) => a + b, 0) / (4 * Math.PI)],
       [0.2126 + 2 * 0.7152 + 4 * 0.0722], 4 * kIntegral_rel);
});

test('surroundings: a spot lights the nearest direction, turned the next', () => {
  const map = new Float32Array(3 * kMapWidth * kMapHeight);
  // Front, on the horizon: the left and right ends of the picture.
  const y = kMapHeight / 2;
  for (const x of [0, kMapWidth - 1]) map[3 * (y * kMapWidth + x)] = 1 / solidAngleOfRow(y);
  const directions = [[0, 0, 1], [1, 0, 0], [0, 0, -1], [-1, 0, 0], [0, 1, 0], [0, -1, 0]];
  const light = new ModelLight(modelOf(directions), kRtiFrame);
  [0, 90, 180, -90].forEach((turn, i) => {
    const [red, green] = light.surroundings(map, turn);
    near([red[i]], [2], kIntegral_rel);
    near([...green], Array(6).fill(0));
  });
});

test('surroundings: none come from below a dome', () => {
  const map = new Float32Array(3 * kMapWidth * kMapHeight).fill(1);
  const upright = { right: [1, 0, 0], up: [0, 0, 1], front: [0, -1, 0] };
  const [red] = new ModelLight(modelOf(spiral(253, 0)), upright).surroundings(map, 0);
  const sum = red.reduce((a, b) => a + b, 0);
  assert.ok(sum > 2 * Math.PI && sum < 2.4 * Math.PI, `${sum / Math.PI} pi`);
});

test('parallel: unit irradiance, in columns of either kind', () => {
  const lamps = new ModelLight(modelOf(spiral(100)), kRtiFrame).parallel([0.6, 0, 0.8]);
  assert.equal(lamps.length, 3);
  near([lamps[2].reduce((a, b) => a + b, 0)], [1]);
  const cube = cubeDirections(4), texels = new ModelLight(modelOf(cube, 1), kRtiFrame);
  for (const direction of spiral(500)) {
    const [light] = texels.parallel(direction);
    near([light.reduce((sum, v, i) => sum + v * solidAngleOf(texels.cube, i), 0)], [1]);
    light.forEach((v, i) => assert.ok(v === 0 || angleBetween(cube[i], direction) < 0.7));
  }
  assert.throws(() => new ModelLight(modelOf(spiral(54), 1), kRtiFrame), ModelError);
});

test('maps: directions there and back, and what is turned is found turned', () => {
  for (const direction of spiral(200)) {
    near(directionOfMap(...mapOfDirection(direction)), direction);
  }
  const map = new Float32Array(3 * kMapWidth * kMapHeight).map((_, i) => Math.floor(i / 3) % kMapWidth);
  // A column 10 texels further to the left in the picture comes to where this one was.
  const at = (turn) => radianceAt(map, turn, directionOfMap(100.5 / kMapWidth, 0.3))[0];
  near([at(0), at(10 * 360 / kMapWidth)], [100, 110], 1e-6);
});

test('made surroundings: finite, lit, and not of one colour', () => {
  for (const name of Object.keys(madeTitles)) {
    const map = makeSurroundings(name);
    assert.equal(map.length, 3 * kMapWidth * kMapHeight);
    assert.ok(map.every((value) => Number.isFinite(value) && value >= 0), name);
    const largest = map.reduce((a, b) => Math.max(a, b), 0);
    const mean = map.reduce((a, b) => a + b, 0) / map.length;
    assert.ok(largest > 5 * mean && mean > 0.01, `${name}: ${largest} ${mean}`);
  }
});

test('viewFrameOf: the picture is the world unless a camera is told', () => {
  for (const text of [undefined, '', '@LFM_CAMERA@', '1 2 3', Array(9).fill(1).join(' '),
                      '1 0 0 0 1 0 0 0 -1']) {
    const { right, up, back } = viewFrameOf(text);
    near([...right, ...up, ...back], [1, 0, 0, 0, 1, 0, 0, 0, 1]);
  }
  // From the side, z up: world y goes away from the viewer.
  const frame = viewFrameOf('1 0 0 0 0 -1 0 1 0');
  near(frame.right, [1, 0, 0]);
  near(frame.up, [0, 0, 1]);
  near(frame.back, [0, -1, 0]);
  const upright = uprightFrameOf(viewFrameOf('1 0 0 0 0.6 -0.8 0 0.8 0.6'));
  near(upright.up, [0, 0, 1]);
  near(upright.front, [0, -1, 0]);
  near(upright.right, [1, 0, 0]);
  // The middle of a picture, behind the object at +y, comes to +x by a turn from above.
  near([turnOfWorld(upright), turnOfWorld(kRtiFrame)], [-90, 0]);
});

test('directionAt: the middle is the viewer, the edge the side, beyond it behind', () => {
  const frame = viewFrameOf('');
  near(directionAt(frame, 0, 0), [0, 0, 1]);
  near(directionAt(frame, 1, 0), [1, 0, 0]);
  near(directionAt(frame, 0, -1), [0, -1, 0]);
  near(directionAt(frame, 0, 0.5), [0, Math.SQRT1_2, Math.SQRT1_2]);
  near(directionAt(frame, -2, 0), [0, 0, -1]);
  near(directionAt(frame, 5, 5), [0, 0, -1]);
  near(turned(frame, [0, 0, 1], Math.PI / 2, 0), [1, 0, 0]);
  near(turned(frame, [0, 0, 1], 0, Math.PI / 6), [0, 0.5, Math.sqrt(0.75)]);
  near(anglesOf(frame, [0.5, Math.SQRT1_2, 0.5]), [45, 45], 1e-9);
});

// A .hdr of `rows`, each an array of [r, g, b, e].
function radiance(rows, encode, header = '#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n') {
  return Buffer.concat([Buffer.from(`${header}-Y ${rows.length} +X ${rows[0].length}\n`),
                        ...rows.map((row) => Buffer.from(encode(row)))]);
}
const plain = (row) => row.flat();
function planes(row) {
  const bytes = [2, 2, row.length >> 8, row.length & 255];
  for (let c = 0; c < 4; ++c) {
    for (let x = 0; x < row.length;) {
      let run = 1;
      while (run < 127 && x + run < row.length && row[x + run][c] === row[x][c]) ++run;
      bytes.push(...(run > 2 ? [128 + run, row[x][c]] : [1, row[x][c]]));
      x += run > 2 ? run : 1;
    }
  }
  return bytes;
}
const kRows = Array.from({ length: 8 }, (_, y) => Array.from({ length: 16 }, (_, x) =>
  [x < 9 ? 7 : 10 * x, 16 * y, 128, x === 15 ? 0 : 120 + y]));

function readRows(bytes) {
  const rows = [];
  readRadiancePicture(new Uint8Array(bytes), 'm.hdr', (y, row) => { rows[y] = [...row]; });
  return rows;
}

test('readRadiancePicture: plain, in runs of each byte, in runs of pixels', () => {
  const expected = kRows.map((row) => row.flatMap(([r, g, b, e]) =>
    [r, g, b].map((value) => (e === 0 ? 0 : value * 2 ** (e - 136)))));
  assert.deepEqual(readRows(radiance(kRows, plain)), expected);
  assert.deepEqual(readRows(radiance(kRows, planes)), expected);
  const repeated = Buffer.from([5, 6, 7, 130, 1, 1, 1, 44, 1, 1, 1, 1, 9, 9, 9, 136]);
  const header = '#?RADIANCE\r\nFORMAT=32-bit_rle_rgbe\r\n\r\n';
  const [row] = readRows(Buffer.concat([Buffer.from(`${header}-Y 1 +X 302\r\n`), repeated]));
  assert.deepEqual(row.slice(0, 3), [5, 6, 7].map((v) => v / 64));
  assert.deepEqual(row.slice(900, 906), [...[5, 6, 7].map((v) => v / 64), 9, 9, 9]);
});

test('readRadiancePicture: refuses every prefix, and heads that cannot be', () => {
  const fails = (bytes, expected) => assert.throws(() => readRows(bytes), (error) => {
    assert.ok(error instanceof ModelError, String(error.stack));
    assert.match(error.message, expected);
    assert.ok(error.message.startsWith('m.hdr: ') && !error.message.includes('\n'));
    return true;
  });
  for (const encode of [plain, planes]) {
    const whole = radiance(kRows, encode);
    for (let length = 0; length < whole.length; ++length) {
      fails(whole.subarray(0, length), /not a Radiance picture|cut short|top left/);
    }
  }
  const head = (size, format = '32-bit_rle_rgbe') =>
    Buffer.from(`#?RADIANCE\nFORMAT=${format}\n\n${size}\n`);
  fails(head('-Y 0 +X 8'), /a side has/);
  fails(head('-Y 65537 +X 8'), /a side has/);
  fails(head('-Y 99999999999999999999 +X 8'), /a side has/);
  fails(head('-Y 65536 +X 65536'), /too many/);
  fails(head('+Y 8 +X 8'), /top left/);
  fails(head('-Y 8 +X 8', '32-bit_rle_xyze'), /save it as RGBE/);
  fails(head('-Y 4096 +X 8192'), /cut short/);
  const run = (...bytes) => Buffer.concat([head('-Y 1 +X 16'), Buffer.from(bytes)]);
  fails(run(2, 2, 0, 16, 128 + 17, 1), /cut short or damaged/);
  fails(run(2, 2, 0, 16, 0, 1), /cut short or damaged/);
  fails(run(1, 1, 1, 5, 1, 1, 1, 1), /cut short or damaged/);
  fails(run(3, 3, 3, 130, 1, 1, 1, 255, 0, 0, 0, 0), /cut short or damaged/);
});

test('readRadiancePicture: damage anywhere is refused or harmless', () => {
  const whole = radiance(kRows, planes);
  for (let at = 0; at < whole.length; ++at) {
    for (const value of [0, 1, 2, 0x7f, 0xff]) {
      const bytes = Buffer.from(whole);
      bytes[at] = value;
      try {
        assert.ok(readRows(bytes).flat().every((v) => Number.isFinite(v) && v >= 0));
      } catch (error) {
        assert.ok(error instanceof ModelError, `${at}: ${error.stack}`);
      }
    }
  }
});

test('readMap: keeps the mean, of pictures smaller and larger', () => {
  for (const [width, height] of [[16, 8], [600, 300], [511, 256]]) {
    const rows = Array.from({ length: height }, (_, y) => Array.from({ length: width }, (_, x) =>
      [(7 * x + 3 * y) % 255 + 1, 100, 50, 136]));
    const map = readMap(new Uint8Array(radiance(rows, plain)), 'm.hdr');
    let mean = 0, expected = 0;
    for (let i = 0; i < map.length; i += 3) mean += map[i] / (map.length / 3);
    for (const row of rows) for (const [r] of row) expected += r / (width * height);
    near([mean, map[1], map[2]], [expected, 100, 50], 1e-3);
  }
  const square = radiance([[[2, 2, 2, 136], [2, 2, 2, 136]], [[2, 2, 2, 136], [2, 2, 2, 136]]], plain);
  assert.throws(() => readMap(new Uint8Array(square), 'm.hdr'), /twice as wide as high/);
});
