// SPDX-License-Identifier: BSD-3-Clause
// The plain mesh with the mean view that any glTF viewer shows: what is seen of a stream until the
// light field's tables have arrived.
import {
  BufferAttribute, BufferGeometry, DoubleSide, Group, LinearFilter, Mesh, MeshBasicMaterial,
  SRGBColorSpace, Texture,
} from 'three';
import { GltfDocument, kUint32, kUint16 } from './gltf_document.js';
import { readPngSize, TexelBudget } from './page_decoding.js';
import { stand } from './placement.js';

export class PlainMesh {
  /** `places`: where it stands, placement.js. */
  constructor(places) {
    // mm, z up: the node's transformation is left out
    this.groups = places.map((place) => {
      const group = new Group();
      stand(group, place);
      return group;
    });
    this.meshes = [];
  }

  /** Resolves with the positions when the mesh and its pictures are there. */
  async load(source) {
    const doc = new GltfDocument(source);
    const primitives = doc.list(source.json.meshes?.[0]?.primitives, 'the plain mesh');
    this.meshes = await Promise.all(primitives.map((primitive) => readPrimitive(doc, primitive)));
    for (const group of this.groups) group.add(...this.meshes.map((mesh) => mesh.clone()));
    return this.meshes.flatMap((mesh) => [...mesh.geometry.getAttribute('position').array]);
  }

  get shown() {
    return this.groups[0].parent !== null;
  }

  show(scene) {
    scene.add(...this.groups);
  }

  remove() {
    if (!this.shown) return;
    for (const group of this.groups) group.removeFromParent();
    for (const { geometry, material } of this.meshes) {
      geometry.dispose();
      material.map.dispose();
      material.dispose();
    }
  }
}

async function readPrimitive(doc, primitive) {
  const { json } = doc.source;
  const texture = json.materials?.[primitive.material]?.pbrMetallicRoughness?.baseColorTexture;
  const image = json.images?.[json.textures?.[texture?.index]?.source];
  const bytes = await doc.source.bufferView(doc.index(image?.bufferView, 'an image'));
  const size = readPngSize(bytes);
  doc.require(size !== null, 'an image is not an 8-bit RGB PNG');
  new TexelBudget(doc.source.name).take(size.width, size.height);
  const [positions, coordinates, indices, picture] = await Promise.all([
    doc.floats(primitive.attributes?.POSITION, 'POSITION', 'VEC3'),
    doc.floats(primitive.attributes?.TEXCOORD_0, 'TEXCOORD_0', 'VEC2'),
    doc.accessor(primitive.indices, 'indices', [kUint16, kUint32], 'SCALAR'),
    createImageBitmap(new Blob([bytes]), { colorSpaceConversion: 'none' }),
  ]);
  doc.require(indices.every((index) => index < positions.length / 3), 'an index is out of range');
  const geometry = new BufferGeometry();
  geometry.setAttribute('position', new BufferAttribute(positions, 3));
  geometry.setAttribute('uv', new BufferAttribute(coordinates, 2));
  geometry.setIndex(new BufferAttribute(indices, 1));
  const map = new Texture(picture);
  map.colorSpace = SRGBColorSpace;
  map.flipY = false;
  map.generateMipmaps = false;
  map.minFilter = LinearFilter;
  map.needsUpdate = true;
  return new Mesh(geometry, new MeshBasicMaterial({ map, side: DoubleSide, toneMapped: false }));
}
