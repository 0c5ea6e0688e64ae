import { BufferAttribute, BufferGeometry, Color, GLSL3, Group, Mesh, Points, RawShaderMaterial, Sphere, Vector3 } from "three";
import { CHUNK } from "./run_data.js";
import { POINT_FRAGMENT, POINT_VERTEX, VOXEL_FRAGMENT, VOXEL_VERTEX } from "./shaders.js";
import { SCENE, robotColor } from "./palette.js";
import { MOST_OWNERS, VoxelMesher } from "./voxel_mesher.js";

const ORIGIN = 32768; // key of the voxel whose lower corner lies at 0

/** Occupied voxels and frontiers of a map, a mesh and a cloud of points for each chunk. */
export class VoxelView {
  constructor(store, facts) {
    this.store = store;
    this.robotFacts = facts.robots;
    this.resolution = facts.resolution;
    this.mesher = new VoxelMesher(store, facts.bounds);
    this.voxels = new Group();
    this.frontiers = new Group();
    this.facesMaterial = new RawShaderMaterial({
      glslVersion: GLSL3, vertexShader: VOXEL_VERTEX, fragmentShader: VOXEL_FRAGMENT,
      uniforms: {
        heights: { value: Array.from({ length: 4 }, () => new Vector3()) },
        owners: { value: Array.from({ length: MOST_OWNERS + 1 }, () => new Vector3()) },
        lowest: { value: (store.heights[0] - ORIGIN) * this.resolution },
        highest: { value: (store.heights[1] + 1 - ORIGIN) * this.resolution },
        shade: { value: 1 }, edges: { value: 0.16 }, by_owner: { value: false },
      },
    });
    this.pointsMaterial = new RawShaderMaterial({
      glslVersion: GLSL3, vertexShader: POINT_VERTEX, fragmentShader: POINT_FRAGMENT,
      uniforms: { size: { value: 100 }, tints: { value: Array.from({ length: MOST_OWNERS + 1 }, () => new Vector3()) } },
      transparent: true, depthWrite: false,
    });
    this.index = makeIndex(4096);
    this.meshes = store.chunks.map((_, c) => this.makeChunk(c, Mesh, this.facesMaterial, this.voxels));
    this.clouds = store.chunks.map((_, c) => this.makeChunk(c, Points, this.pointsMaterial, this.frontiers));
  }

  makeChunk(c, Kind, material, group) {
    const geometry = new BufferGeometry();
    const half = CHUNK / 2;
    geometry.boundingSphere = new Sphere(new Vector3(half, half, half), Math.sqrt(3) * half);
    const object = new Kind(geometry, material);
    const corner = this.store.run.chunks.corners.items.subarray(3 * c, 3 * c + 3);
    object.position.set(...Array.from(corner, (k) => (k - ORIGIN) * this.resolution));
    object.scale.setScalar(this.resolution);
    object.visible = false;
    object.updateMatrix();
    object.matrixAutoUpdate = false;
    group.add(object);
    return object;
  }

  /** Rebuilds what has changed. */
  update() {
    const { store, mesher } = this;
    for (let c = 0; c < store.dirty.length; ++c) {
      if (!store.dirty[c]) continue;
      store.dirty[c] = 0;
      mesher.make(c);
      this.fill(this.meshes[c], mesher.corners, 16 * mesher.faces);
      this.fill(this.clouds[c], mesher.points, 4 * mesher.frontiers);
      this.meshes[c].geometry.setDrawRange(0, 6 * mesher.faces);
      this.clouds[c].geometry.setDrawRange(0, mesher.frontiers);
      this.growIndex(mesher.faces);
      if (this.meshes[c].geometry.index !== this.index) this.meshes[c].geometry.setIndex(this.index);
    }
  }

  fill(object, bytes, length) {
    object.visible = length > 0;
    if (length === 0) return;
    const { geometry } = object;
    let attribute = geometry.getAttribute("corner");
    if (!attribute || attribute.array.length < length) {
      let capacity = 1024;
      while (capacity < length) capacity *= 2;
      geometry.dispose();
      attribute = new BufferAttribute(new Uint8Array(capacity), 4);
      geometry.setAttribute("corner", attribute);
    }
    for (let i = 0; i < length; ++i) attribute.array[i] = bytes[i];
    attribute.clearUpdateRanges();
    attribute.addUpdateRange(0, length);
    attribute.needsUpdate = true;
  }

  growIndex(faces) {
    if (6 * faces <= this.index.count) return;
    let capacity = this.index.count / 6;
    while (capacity < faces) capacity *= 2;
    this.index = makeIndex(capacity);
    for (const mesh of this.meshes) mesh.geometry.setIndex(this.index);
  }

  /** Hides the voxels in the layer of this key and above. */
  setCut(key) {
    const corners = this.store.run.chunks.corners.items, low = Math.min(key, this.mesher.cut);
    this.mesher.cut = key;
    this.store.dirty.forEach((_, c) => {
      if (corners[3 * c + 2] + CHUNK >= low) this.store.dirty[c] = 1;
    });
  }

  setClosed(closed) {
    this.mesher.closed = closed;
    this.store.dirty.fill(1);
  }

  setColors(theme, byOwner) {
    const scene = SCENE[theme], { uniforms } = this.facesMaterial;
    scene.heights.forEach((color, i) => setVector(uniforms.heights.value[i], color));
    // Paler than the robots themselves, so that their paths stand out.
    setVector(wall, scene.wall);
    const robots = this.robotFacts;
    for (let i = 1; i <= MOST_OWNERS; ++i) {
      setVector(uniforms.owners.value[i], robotColor(robots[(i - 1) % robots.length], theme));
      uniforms.owners.value[i].lerp(wall, 0.5);
    }
    uniforms.shade.value = scene.shade;
    uniforms.by_owner.value = byOwner;
    const { tints } = this.pointsMaterial.uniforms;
    tints.value.forEach((tint, i) => setVector(tint, i === 0 ? scene.frontier : robotColor(robots[(i - 1) % robots.length], theme)));
  }

  /** @param pixels height of the view @param slope tangent of half the camera's opening angle */
  setPointScale(pixels, slope) {
    this.pointsMaterial.uniforms.size.value = (0.5 * this.resolution * pixels) / (2 * slope);
  }

  countFrontiers() {
    return this.clouds.reduce((sum, cloud) => sum + (cloud.visible ? cloud.geometry.drawRange.count : 0), 0);
  }

  dispose() {
    for (const object of [...this.meshes, ...this.clouds]) object.geometry.dispose();
    this.facesMaterial.dispose();
    this.pointsMaterial.dispose();
  }
}

function makeIndex(faces) {
  const index = new Uint32Array(6 * faces);
  for (let f = 0; f < faces; ++f) index.set([4 * f, 4 * f + 1, 4 * f + 2, 4 * f, 4 * f + 2, 4 * f + 3], 6 * f);
  return new BufferAttribute(index, 1);
}

const color = new Color(), wall = new Vector3();
/** In sRGB, not linear. */
function setVector(vector, css) {
  color.set(css).convertLinearToSRGB();
  vector.set(color.r, color.g, color.b);
}
