// The model on the canvas: camera, drawing, and what a point of the picture shows.

import * as THREE from "three";
import { OrbitControls } from "three/addons/controls/OrbitControls.js";
import { GLTFLoader } from "three/addons/loaders/GLTFLoader.js";

import { steps, stepAt, toLightAt, codeSeconds } from "./bake_data.js";
import { MODE, pageTexture, sharedUniforms, surfaceMaterial } from "./surface.js";

const FIELD_DEG = 45; // of the picture's height
const NARROWEST = 1.2; // width / height below which the field grows, so that the model stays in sight
const SHARPEST = 2; // device pixels per CSS pixel; more cost and do not show

export class View {
  constructor(canvas, bake) {
    this.canvas = canvas;
    this.bake = bake;
    this.shared = sharedUniforms();
    this.shared.width_codes.value = bake.width_steps * bake.codes_per_step;
    this.shared.path_codes.value = steps(bake) * bake.codes_per_step;
    for (const name of ["closed", "begins_up", "ends_up"]) this.shared[name].value = bake[name];
    this.renderer = new THREE.WebGLRenderer({ canvas, antialias: true, alpha: true });
    this.checkLimits();
    this.pages = bake.pages.map((page, index) => ({
      ...page,
      index,
      texture: pageTexture(page, bake.bits),
    }));
    this.scene = new THREE.Scene();
    this.camera = new THREE.PerspectiveCamera(FIELD_DEG);
    this.controls = new OrbitControls(this.camera, canvas);
    this.controls.enableDamping = true;
    this.controls.maxPolarAngle = 0.55 * Math.PI;
    this.controls.addEventListener("change", () => (this.stale = true));
    this.pixel = new THREE.WebGLRenderTarget(1, 1);
    this.stale = true;
  }

  checkLimits() {
    const most = this.renderer.capabilities.maxTextureSize;
    const largest = Math.max(...this.bake.pages.map((page) => page.side));
    if (largest > most) {
      throw new Error(`a page has ${largest} texels a side; this device holds ${most}: bake with a larger --texel`);
    }
  }

  async load(url) {
    const gltf = await new GLTFLoader().loadAsync(url);
    this.dress(gltf);
    const model = gltf.scene;
    model.updateMatrixWorld(true);
    const box = new THREE.Box3();
    model.traverse((node) => node.isMesh && box.expandByObject(node));
    const sphere = box.getBoundingSphere(new THREE.Sphere());
    // Models in coordinates of a country come to the origin, for the camera's sake.
    this.radius_m = Math.max(sphere.radius, 1e-6);
    const pivot = new THREE.Group();
    pivot.position.copy(sphere.center).negate();
    pivot.add(model);
    this.scene.add(pivot);
    this.scene.updateMatrixWorld(true);
    this.frame(gltf.cameras);
    this.resize();
  }

  // Gives each primitive its page. web.json counts them in the order of the file's meshes.
  dress(gltf) {
    const first = [0];
    for (const mesh of gltf.parser.json.meshes) first.push(first.at(-1) + mesh.primitives.length);
    if (first.at(-1) !== this.bake.mesh_pages.length) {
      throw new Error(`scene.glb has ${first.at(-1)} meshes, and web.json pages for ${this.bake.mesh_pages.length}`);
    }
    const found = [];
    gltf.scene.traverse((node) => node.isMesh && found.push(node));
    for (const node of found) {
      const { meshes, primitives = 0 } = gltf.parser.associations.get(node);
      const page = this.pages[this.bake.mesh_pages[first[meshes] + primitives]];
      if (!node.geometry.attributes.normal) {
        node.geometry = node.geometry.toNonIndexed();
        node.geometry.computeVertexNormals();
      }
      node.material = surfaceMaterial(node.material, page, this.shared);
    }
  }

  // The file's own camera, else one from above.
  frame(cameras) {
    const own = cameras.find((camera) => camera.isPerspectiveCamera);
    const { camera, controls, radius_m } = this;
    camera.near = radius_m / 500;
    camera.far = radius_m * 20;
    if (own) {
      own.updateWorldMatrix(true, false);
      const forward = own.getWorldDirection(new THREE.Vector3());
      own.getWorldPosition(camera.position);
      const ahead_m = Math.max(-camera.position.dot(forward), 0.2 * radius_m);
      controls.target.copy(camera.position).addScaledVector(forward, ahead_m);
      this.field_deg = own.fov;
    } else {
      camera.position.set(1, 0.9, 1.3).setLength(2.4 * radius_m);
      this.field_deg = FIELD_DEG;
    }
    controls.minDistance = 0.02 * radius_m;
    controls.maxDistance = 6 * radius_m;
    controls.update();
  }

  // Moves the camera around what it looks at: to the right, and up, as far as dragging may.
  turn(right_rad, up_rad) {
    const { camera, controls } = this;
    const from = new THREE.Spherical().setFromVector3(camera.position.clone().sub(controls.target));
    from.theta += right_rad;
    from.phi = THREE.MathUtils.clamp(from.phi - up_rad, controls.minPolarAngle, controls.maxPolarAngle);
    camera.position.setFromSpherical(from.makeSafe()).add(controls.target);
    controls.update();
  }

  // Multiplies its distance.
  approach(factor) {
    const { camera, controls } = this;
    const from = camera.position.clone().sub(controls.target);
    const distance = THREE.MathUtils.clamp(from.length() * factor, controls.minDistance, controls.maxDistance);
    camera.position.copy(controls.target).add(from.setLength(distance));
    controls.update();
  }

  resize() {
    const { clientWidth: width, clientHeight: height } = this.canvas;
    this.renderer.setPixelRatio(Math.min(window.devicePixelRatio, SHARPEST));
    this.renderer.setSize(width, height, false);
    const aspect = width / Math.max(height, 1);
    const slope = Math.tan(THREE.MathUtils.degToRad(0.5 * this.field_deg));
    this.camera.fov = THREE.MathUtils.radToDeg(2 * Math.atan(slope * Math.max(1, NARROWEST / aspect)));
    this.camera.aspect = aspect;
    this.camera.updateProjectionMatrix();
    this.stale = true;
  }

  setTime(time_s) {
    this.shared.at_codes.value = stepAt(this.bake, time_s) * this.bake.codes_per_step;
    this.shared.to_sun_ws.value.fromArray(toLightAt(this.bake, time_s));
    this.stale = true;
  }

  showHours(on, most_s) {
    this.base_mode = on ? MODE.hours : MODE.lit;
    this.shared.most_codes.value = most_s / codeSeconds(this.bake);
    this.stale = true;
  }

  draw() {
    this.controls.update();
    if (!this.stale) return false;
    this.stale = false;
    this.shared.mode.value = this.base_mode ?? MODE.lit;
    this.renderer.render(this.scene, this.camera);
    return true;
  }

  // One pixel of the picture in another mode, as four bytes.
  pixelAt(x_px, y_px, mode) {
    const { renderer, camera, canvas } = this;
    camera.setViewOffset(canvas.clientWidth, canvas.clientHeight, x_px, y_px, 1, 1);
    this.shared.mode.value = mode;
    const bytes = new Uint8Array(4);
    renderer.setRenderTarget(this.pixel);
    renderer.setClearColor(0x000000, 0);
    renderer.render(this.scene, camera);
    renderer.readRenderTargetPixels(this.pixel, 0, 0, 1, 1, bytes);
    renderer.setRenderTarget(null);
    camera.clearViewOffset();
    return bytes;
  }

  // What a point of the canvas shows: { page, x, y, point_ws }, or null for the sky. Alpha masks are
  // seen through, as the shader itself tells.
  pick(x_px, y_px) {
    const page = this.pixelAt(x_px, y_px, MODE.page);
    if (page[3] === 0) return null;
    const texel = this.pixelAt(x_px, y_px, MODE.texel);
    const depth = this.pixelAt(x_px, y_px, MODE.depth);
    const { clientWidth, clientHeight } = this.canvas;
    const point_ws = new THREE.Vector3(
      (2 * (x_px + 0.5)) / clientWidth - 1,
      1 - (2 * (y_px + 0.5)) / clientHeight,
      (2 * (depth[0] + 256 * depth[1] + 65536 * depth[2])) / 16777215 - 1,
    ).unproject(this.camera);
    return {
      page: page[0] + 256 * page[1] - 1,
      x: texel[0] + 256 * texel[1],
      y: texel[2] + 256 * texel[3],
      point_ws,
    };
  }

  // Where a point stands on the canvas, or null behind the camera.
  project(point_ws) {
    const p = point_ws.clone().project(this.camera);
    if (p.z > 1) return null;
    return { x: 0.5 * (1 + p.x) * this.canvas.clientWidth, y: 0.5 * (1 - p.y) * this.canvas.clientHeight };
  }

  // What the shader sees of the sun at each pixel of the canvas, rows from the bottom, four bytes: of
  // 65535 parts the low and the high byte, 0, and 0 where nothing is drawn. For tests.
  visibilityBytes() {
    const { clientWidth: width, clientHeight: height } = this.canvas;
    const target = new THREE.WebGLRenderTarget(width, height);
    const bytes = new Uint8Array(4 * width * height);
    this.shared.mode.value = MODE.visibility;
    this.renderer.setRenderTarget(target);
    this.renderer.setClearColor(0x000000, 0);
    this.renderer.render(this.scene, this.camera);
    this.renderer.readRenderTargetPixels(target, 0, 0, width, height, bytes);
    this.renderer.setRenderTarget(null);
    target.dispose();
    this.stale = true;
    return bytes;
  }
}
