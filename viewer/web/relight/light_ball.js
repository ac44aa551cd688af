// SPDX-License-Identifier: BSD-3-Clause
// A small ball beside the controls that shows the light: a white one under one light, or a mirror.
import { radianceAt } from './model_light.js';
import { dot, minus, scale, vectorAt } from './vectors.js';
import { inView, inWorld } from './view_frame.js';

const kMostMarks = 1500; // directions of the model, of which lights are mixed
const kMean = 0.3; // what surroundings show on average

export class LightBall {
  /** `frame`, `upright`: view_frame.js; `directions`: of the model. */
  constructor(canvas, frame, upright, directions) {
    this.canvas = canvas;
    this.frame = frame;
    this.upright = upright;
    this.marks = [];
    for (let i = 0; i < directions.length / 3 && directions.length / 3 <= kMostMarks; ++i) {
      const [x, y, z] = inView(frame, vectorAt(directions, i));
      if (z >= 0) this.marks.push([x, y]);
    }
    this.normals = normalsOf(canvas.width);
  }

  /** Where x, y lie on the ball (1 at its rim), as a direction of the world. */
  directionAt(x, y) {
    const radius = Math.max(1, Math.hypot(x, y));
    const [a, b] = [x / radius, y / radius];
    return inWorld(this.frame, [a, b, Math.sqrt(Math.max(0, 1 - a * a - b * b))]);
  }

  showLight(direction) {
    const light = inView(this.frame, direction);
    this.paint((normal) => {
      const lit = Math.max(0, dot(normal, light));
      const shine = Math.max(0, 2 * dot(normal, light) * normal[2] - light[2]) ** 30;
      return [0.03 + 0.5 * lit + 0.5 * shine, 0.03 + 0.5 * lit + 0.45 * shine,
              0.035 + 0.48 * lit + 0.35 * shine];
    });
    this.drawMarks(light);
  }

  showSurroundings(map, degrees) {
    const mean = map.reduce((sum, value) => sum + Math.min(value, 20), 0) / map.length;
    const gain = mean > 0 ? kMean / mean : 1;
    const { right, up, front } = this.upright;
    this.paint((normal) => {
      const mirrored = minus(scale(normal, 2 * normal[2]), [0, 0, 1]);
      const world = inWorld(this.frame, mirrored);
      const local = [dot(right, world), dot(up, world), dot(front, world)];
      return radianceAt(map, degrees, local).map((value) => gain * value);
    });
  }

  /** `radiance` of a normal in the picture's axes. */
  paint(radiance) {
    const context = this.canvas.getContext('2d'), size = this.canvas.width;
    const image = context.createImageData(size, size);
    for (const { at, normal, cover } of this.normals) {
      radiance(normal).forEach((value, c) => {
        image.data[4 * at + c] = 255 * Math.min(1, Math.max(0, value)) ** (1 / 2.2);
      });
      image.data[4 * at + 3] = 255 * cover;
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

function normalsOf(size) {
  const normals = [], radius = size / 2;
  for (let at = 0; at < size * size; ++at) {
    const x = (at % size + 0.5) / radius - 1, y = 1 - (Math.floor(at / size) + 0.5) / radius;
    const flat = Math.hypot(x, y);
    const cover = Math.max(0, Math.min(1, (1 - flat) * radius + 0.5));
    if (cover === 0) continue;
    const shrink = flat > 1 ? 1 / flat : 1;
    normals.push({ at, cover, normal: [x * shrink, y * shrink,
                                       Math.sqrt(Math.max(0, 1 - (flat * shrink) ** 2))] });
  }
  return normals;
}
