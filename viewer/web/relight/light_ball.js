// SPDX-License-Identifier: BSD-3-Clause
// A small ball beside the controls that shows the light: a white one under one light, or a mirror.
import { radianceAtMap } from './model_light.js';
import { mapOfDirection } from './surroundings.js';
import { dot, minus, scale, vectorAt } from './vectors.js';
import { inView, inWorld } from './view_frame.js';

const kMostMarks = 1500; // directions of the model, of which lights are mixed
const kMean = 0.3; // what surroundings show on average
const kMostInMean = 20; // the sun would leave the rest dark
const kCodes = Uint8Array.from({ length: 1024 }, (_, i) => 255 * (i / 1023) ** (1 / 2.2));

export class LightBall {
  /** `frame`, `upright`: view_frame.js; `directions`: of the model. */
  constructor(canvas, frame, upright, directions) {
    this.canvas = canvas;
    this.frame = frame;
    this.marks = [];
    for (let i = 0; i < directions.length / 3 && directions.length / 3 <= kMostMarks; ++i) {
      const [x, y, z] = inView(frame, vectorAt(directions, i));
      if (z >= 0) this.marks.push([x, y]);
    }
    this.pixels = pixelsOf(canvas.width);
    for (const pixel of this.pixels) pixel.mirrored = this.mirroredBy(pixel.normal, upright);
    this.mean = { map: null, value: 0 }; // of the surroundings shown last
  }

  /** Where x, y lie on the ball (1 at its rim), as a direction of the world. */
  directionAt(x, y) {
    const radius = Math.max(1, Math.hypot(x, y));
    const [a, b] = [x / radius, y / radius];
    return inWorld(this.frame, [a, b, Math.sqrt(Math.max(0, 1 - a * a - b * b))]);
  }

  showLight(direction) {
    const light = inView(this.frame, direction);
    this.paint(({ normal }) => {
      const lit = Math.max(0, dot(normal, light));
      const shine = Math.max(0, 2 * dot(normal, light) * normal[2] - light[2]) ** 30;
      return [0.03 + 0.5 * lit + 0.5 * shine, 0.03 + 0.5 * lit + 0.45 * shine,
              0.035 + 0.48 * lit + 0.35 * shine];
    });
    this.drawMarks(light);
  }

  showSurroundings(map, degrees) {
    if (this.mean.map !== map) {
      const sum = map.reduce((total, value) => total + Math.min(value, kMostInMean), 0);
      this.mean = { map, value: sum / map.length };
    }
    const gain = this.mean.value > 0 ? kMean / this.mean.value : 1;
    this.paint(({ mirrored }) =>
      radianceAtMap(map, degrees, mirrored).map((value) => gain * value));
  }

  /** Where in a map lies what a mirror with this normal shows. */
  mirroredBy(normal, { right, up, front }) {
    const world = inWorld(this.frame, minus(scale(normal, 2 * normal[2]), [0, 0, 1]));
    return mapOfDirection([dot(right, world), dot(up, world), dot(front, world)]);
  }

  /** `radiance` of a pixel (pixelsOf). */
  paint(radiance) {
    const context = this.canvas.getContext('2d'), size = this.canvas.width;
    const image = context.createImageData(size, size);
    for (const pixel of this.pixels) {
      const color = radiance(pixel), to = 4 * pixel.at;
      for (let c = 0; c < 3; ++c) {
        image.data[to + c] = kCodes[Math.min(1023, Math.max(0, 1023 * color[c])) | 0];
      }
      image.data[to + 3] = 255 * pixel.cover;
    }
    context.putImageData(image, 0, 0);
  }

  drawMarks(light) {
    const context = this.canvas.getContext('2d'), radius = this.canvas.width / 2;
    const disc = ([x, y], size) => {
      context.beginPath();
      context.arc(radius * (1 + x), radius * (1 - y), size, 0, 2 * Math.PI);
    };
    context.fillStyle = 'rgb(108 184 255 / 45%)';
    for (const mark of this.marks) {
      disc(mark, radius / 70);
      context.fill();
    }
    const flat = Math.hypot(light[0], light[1]), behind = light[2] < 0;
    const place = behind && flat > 0 ? [light[0] / flat, light[1] / flat] : [light[0], light[1]];
    disc(scale([...place, 0], 0.92).slice(0, 2), radius / 11);
    context.fillStyle = behind ? 'transparent' : '#ffd75e';
    context.strokeStyle = behind ? '#ffd75e' : '#000000';
    context.lineWidth = radius / 30;
    context.fill();
    context.stroke();
  }
}

/** [{at, cover, normal}]: the ball's pixels, how much it covers of each, in the picture's axes. */
function pixelsOf(size) {
  const pixels = [], radius = size / 2;
  for (let at = 0; at < size * size; ++at) {
    const x = (at % size + 0.5) / radius - 1, y = 1 - (Math.floor(at / size) + 0.5) / radius;
    const flat = Math.hypot(x, y);
    const cover = Math.max(0, Math.min(1, (1 - flat) * radius + 0.5));
    if (cover === 0) continue;
    const shrink = flat > 1 ? 1 / flat : 1;
    const normal = [x * shrink, y * shrink, Math.sqrt(Math.max(0, 1 - (flat * shrink) ** 2))];
    pixels.push({ at, cover, normal });
  }
  return pixels;
}
