// The model's materials, all drawn by one shader; what they share is one object, set once a frame.

import * as THREE from "three";

import { falseColorGlsl } from "./false_color.js";
import fragmentGlsl from "./surface.frag.glsl";
import vertexGlsl from "./surface.vert.glsl";
import visibilityGlsl from "./visibility.glsl";

export const MODE = { lit: 0, hours: 1, texel: 2, page: 3, depth: 4, visibility: 5 };

// A page as a texture of whole numbers; the shader fetches its texels by their indices.
export const pageTexture = (page, bits) => {
  const { side, layers, numbers } = page;
  const texture = new THREE.DataArrayTexture(numbers, side, side, layers);
  texture.format = THREE.RGBAIntegerFormat;
  texture.type = bits === 8 ? THREE.UnsignedByteType : THREE.UnsignedShortType;
  texture.internalFormat = bits === 8 ? "RGBA8UI" : "RGBA16UI";
  texture.unpackAlignment = 1;
  texture.needsUpdate = true;
  return texture;
};

export const sharedUniforms = () => ({
  mode: { value: MODE.lit },
  at_codes: { value: 0 },
  width_codes: { value: 1 },
  path_codes: { value: 1 },
  closed: { value: false },
  begins_up: { value: false },
  ends_up: { value: false },
  most_codes: { value: 1 },
  to_sun_ws: { value: new THREE.Vector3(0, 1, 0) },
});

// `material`: as GLTFLoader makes it.
export const surfaceMaterial = (material, page, shared) => {
  const map = material.map ?? null;
  map?.updateMatrix();
  const { r, g, b } = material.color;
  return new THREE.ShaderMaterial({
    defines: {
      ...(map ? { HAS_MAP: 1 } : {}),
      ...(material.vertexColors ? { HAS_COLOR: 1 } : {}),
    },
    uniforms: {
      ...shared,
      intervals: { value: page.texture },
      page: { value: page.index },
      base_color: { value: new THREE.Vector4(r, g, b, material.opacity) },
      alpha_cutoff: { value: material.alphaTest },
      map: { value: map },
      map_from_uv: { value: map ? map.matrix : new THREE.Matrix3() },
    },
    vertexShader: vertexGlsl,
    fragmentShader: `#define PAIRS ${page.pairs}\n${visibilityGlsl}${falseColorGlsl}${fragmentGlsl}`,
    side: material.side,
  });
};
