// SPDX-License-Identifier: BSD-3-Clause
// The plain mesh with the mean view that any glTF viewer shows: what is seen of a stream until the
// light field's tables have arrived.
import {
  BufferAttribute, BufferGeometry, DoubleSide, Group, LinearFilter, Mesh, MeshBasicMaterial,
  SRGBColorSpace, Texture,
} from 'three';
import { GltfDocument, kUint32, kUint16 } from './gltf_document.js';
import { boundsOf } from './orbit_camera.js';
import { readPngSize, TexelBudget } from './page_decoding.js';

export class PlainMesh {
  constructor() {
    this.object = new Group(); // mm, z up: the node's transformation is left out
  }

  /** Resolves with the bounds (orbit_camera.js) when the mesh and its pictures are there. */
  async load(source) {
    const doc = new GltfDocument(source);
    const primitives = doc.list(source.json.meshes?.[0]?.primitives, 'the plain mesh');
    const meshes = await Promise.all(primitives.map((primitive) => readPrimitive(doc, primitive)));
    this.object.add(...meshes);
    const positions = meshes.flatMap((mesh) => [...mesh.geometry.getAttribute('position').array]);
    return boundsOf(positions);
  }

  remove() {
    if (this.object.parent === null) return;
    this.object.removeFromParent();
    for (const mesh of this.object.children) {
      mesh.geometry.dispose();
      mesh.material.map.dispose();
      mesh.material.dispose();
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
