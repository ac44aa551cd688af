// SPDX-License-Identifier: BSD-3-Clause
// A model file of a scene, at all places where it stands: from its bytes to what is drawn.
import { placedPart } from './bounds.js';
import { readLightField } from './light_field.js';
import { LightFieldObject } from './light_field_object.js';
import { stand } from './placement.js';
import { PlainMesh } from './plain_mesh.js';

export class ShownModel {
  /** `model`: of findModels (model_bytes.js). `options`: of LightFieldObject. */
  constructor({ name, places, open }, options) {
    this.name = name;
    this.places = places;
    this.openSource = open;
    this.options = options;
    this.source = null;
    this.bytesShare = 0;
    this.plain = new PlainMesh(places);
    this.object = null; // LightFieldObject, once its tables are read
    this.copies = []; // of it, at the places after the first
    this.parts = []; // bounds.js
    this.error = null;
  }

  async open(onProgress) {
    this.source = await this.openSource((share) => {
      this.bytesShare = share;
      onProgress();
    });
    if (this.source.whole) this.bytesShare = 1;
  }

  /** The mean view as other viewers show it: in a file it stands before the tables. */
  async showPlain(scene) {
    const positions = await this.plain.load(this.source);
    if (this.drawn) return;
    this.measure(positions);
    this.plain.show(scene);
  }

  async readTables(scene) {
    const field = await readLightField(this.source);
    this.object = new LightFieldObject(field, this.options);
    this.copies = this.places.slice(1).map(() => this.object.another());
    [this.object, ...this.copies].forEach((object, i) => {
      stand(object, this.places[i]);
      scene.add(object);
    });
    this.measure(field.vertices);
  }

  measure(positions) {
    this.parts = this.places.map((place) => placedPart(positions, place));
  }

  get terms() {
    return this.object?.field.terms ?? 0;
  }

  get loadedTerms() {
    return this.object?.loadedTerms ?? -1;
  }

  /** Whether its light field is drawn. */
  get drawn() {
    return this.object?.mesh.visible ?? false;
  }

  /** Whether its mean view, or more, is on the screen. */
  get shown() {
    return this.loadedTerms >= 0 || this.plain.shown;
  }

  /** What could not be shown to its end; what is there of it stays. */
  fail(error) {
    this.error = error;
    if (this.drawn || this.object === null) return;
    this.object.dispose();
    for (const object of [this.object, ...this.copies]) object.removeFromParent();
    if (!this.plain.shown) this.parts = [];
  }
}
