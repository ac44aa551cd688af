// SPDX-License-Identifier: BSD-3-Clause
export { GlbSource } from './glb_source.js';
export { LightFieldPlugin } from './gltf_plugin.js';
export { kExtension, readLightField } from './light_field.js';
export { LightFieldObject } from './light_field_object.js';
export { ModelError } from './model_error.js';
