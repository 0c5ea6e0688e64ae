import { CHUNK, FREE, OCCUPIED, UNKNOWN } from "./run_data.js";

const P = CHUNK + 2; // edge of a chunk with a layer of its neighbours around
const STRIDE = [1, P, P * P];
const STATE = 3;
/** Robots that are told apart, as many as a task has at most; any others count as the last of them. */
export const MOST_OWNERS = 32;

/**
 * Makes the shapes of one chunk: the faces of occupied voxels next to free space, merged into rectangles
 * if the same robot saw them first, and frontiers. The buffers belong to the mesher; the next chunk
 * overwrites them.
 */
export class VoxelMesher {
  constructor(store, bounds) {
    this.store = store;
    this.bounds = bounds; // [[x, y, z], [x, y, z]] keys; frontiers lie within
    this.cut = 65536; // voxels with this z or above are not shown
    this.closed = false; // also faces next to unknown space
    this.padded = new Uint8Array(P * P * P);
    this.mask = new Uint8Array(CHUNK * CHUNK);
    this.corners = new Uint8Array(16 * 4096); // x, y, z, side + 6 * owner; four for each face
    this.faces = 0;
    this.points = new Uint8Array(4 * 4096);
    this.frontiers = 0;
  }

  make(c) {
    const { store } = this;
    this.faces = 0;
    this.frontiers = 0;
    const corner = store.run.chunks.corners.items.subarray(3 * c, 3 * c + 3);
    this.top = Math.min(CHUNK, this.cut - corner[2]); // layers that are shown
    if (this.top <= 0) return;
    this.gather(c);
    this.findFrontiers(corner);
    if (store.occupied[c] === 0) return;
    this.openCut(corner);
    for (let side = 0; side < 6; ++side) this.makeSide(side);
  }

  gather(c) {
    const { padded, store } = this, voxels = store.chunks[c];
    for (let z = 0; z < CHUNK; ++z)
      for (let y = 0; y < CHUNK; ++y) {
        const from = (z << 10) | (y << 5);
        const to = 1 + (y + 1) * P + (z + 1) * P * P;
        for (let x = 0; x < CHUNK; ++x) padded[to + x] = voxels[from + x];
      }
    for (let side = 0; side < 6; ++side) {
      const n = store.neighbours[6 * c + side], other = n < 0 ? null : store.chunks[n];
      const axis = side >> 1, u = axis === 0 ? 1 : 0, v = axis === 2 ? 1 : 2;
      const layer = side & 1 ? CHUNK + 1 : 0, from = (side & 1 ? 0 : CHUNK - 1) << (5 * axis);
      for (let j = 0; j < CHUNK; ++j)
        for (let i = 0; i < CHUNK; ++i)
          padded[layer * STRIDE[axis] + (i + 1) * STRIDE[u] + (j + 1) * STRIDE[v]] = other ? other[from | (i << (5 * u)) | (j << (5 * v))] : UNKNOWN;
    }
  }

  /** The voxels above the cut count as free. */
  openCut(corner) {
    if (corner[2] + this.top !== this.cut) return;
    const layer = (this.top + 1) * P * P;
    for (let y = 1; y <= CHUNK; ++y) this.padded.fill(FREE, layer + y * P + 1, layer + y * P + 1 + CHUNK);
  }

  makeSide(side) {
    const { padded, mask } = this;
    const axis = side >> 1, u = axis === 0 ? 1 : 0, v = axis === 2 ? 1 : 2;
    const ahead = side & 1 ? STRIDE[axis] : -STRIDE[axis];
    const layers = axis === 2 ? this.top : CHUNK, rows = v === 2 ? this.top : CHUNK;
    const open = this.closed ? 0b011 : 0b010; // states next to which a face is drawn, by bit
    for (let layer = 0; layer < layers; ++layer) {
      let any = false;
      for (let j = 0; j < rows; ++j) {
        let at = (layer + 1) * STRIDE[axis] + STRIDE[u] + (j + 1) * STRIDE[v];
        for (let i = 0; i < CHUNK; ++i, at += STRIDE[u]) {
          const voxel = padded[at];
          const shown = (voxel & STATE) === OCCUPIED && ((open >> (padded[at + ahead] & STATE)) & 1) === 1;
          mask[j * CHUNK + i] = shown ? voxel : 0;
          any ||= shown;
        }
      }
      if (any) this.merge(side, layer + (side & 1), u, v, axis, rows);
    }
  }

  /** Covers the mask with rectangles of one value each: as wide as they get, then as high. */
  merge(side, depth, u, v, axis, rows) {
    const { mask } = this;
    for (let j = 0; j < rows; ++j)
      for (let i = 0; i < CHUNK; ) {
        const value = mask[j * CHUNK + i];
        if (value === 0) {
          ++i;
          continue;
        }
        let width = 1;
        while (i + width < CHUNK && mask[j * CHUNK + i + width] === value) ++width;
        let height = 1;
        for (let same = true; j + height < rows; ++height) {
          for (let k = 0; k < width && same; ++k) same = mask[(j + height) * CHUNK + i + k] === value;
          if (!same) break;
        }
        for (let h = 0; h < height; ++h) mask.fill(0, (j + h) * CHUNK + i, (j + h) * CHUNK + i + width);
        this.addFace(side + 6 * Math.min(value >> 2, MOST_OWNERS), axis, u, v, depth, i, j, width, height);
        i += width;
      }
  }

  addFace(tag, axis, u, v, depth, i, j, width, height) {
    if (16 * (this.faces + 1) > this.corners.length) {
      const larger = new Uint8Array(2 * this.corners.length);
      larger.set(this.corners);
      this.corners = larger;
    }
    // Counter-clockwise as seen from outside; the axes u and v turn in the other direction around y.
    const flip = ((tag & 1) === 1) === (axis !== 1);
    for (let corner = 0; corner < 4; ++corner) {
      const k = flip ? corner : 3 - corner, at = 16 * this.faces + 4 * corner;
      this.corners[at + axis] = depth;
      this.corners[at + u] = i + (k === 1 || k === 2 ? width : 0);
      this.corners[at + v] = j + (k >= 2 ? height : 0);
      this.corners[at + 3] = tag;
    }
    ++this.faces;
  }

  findFrontiers(corner) {
    const { padded } = this, [low, high] = this.bounds;
    const from = [0, 1, 2].map((k) => Math.max(0, low[k] - corner[k])), to = [0, 1, 2].map((k) => Math.min(CHUNK - 1, high[k] - corner[k]));
    for (let z = from[2]; z <= Math.min(to[2], this.top - 1); ++z)
      for (let y = from[1]; y <= to[1]; ++y) {
        let at = 1 + from[0] + (y + 1) * P + (z + 1) * P * P;
        for (let x = from[0]; x <= to[0]; ++x, ++at) {
          if ((padded[at] & STATE) !== UNKNOWN) continue;
          if ((padded[at - 1] & STATE) === FREE || (padded[at + 1] & STATE) === FREE || (padded[at - P] & STATE) === FREE || (padded[at + P] & STATE) === FREE || (padded[at - P * P] & STATE) === FREE || (padded[at + P * P] & STATE) === FREE)
            this.addPoint(x, y, z, this.store.assignment.ownerOf(corner[0] + x, corner[1] + y, corner[2] + z));
        }
      }
  }

  /** @param owner as Assignment.ownerOf says it */
  addPoint(x, y, z, owner) {
    if (4 * (this.frontiers + 1) > this.points.length) {
      const larger = new Uint8Array(2 * this.points.length);
      larger.set(this.points);
      this.points = larger;
    }
    this.points.set([x, y, z, Math.min(owner, MOST_OWNERS)], 4 * this.frontiers++);
  }
}
