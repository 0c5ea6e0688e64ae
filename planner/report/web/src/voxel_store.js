import { Assignment } from "./assignment.js";
import { CHUNK, OCCUPIED } from "./run_data.js";

const VOXELS = CHUNK ** 3;
const STATE = 3;

/**
 * The map of a run at the end of one of its steps. Applies only the changes between steps, and remembers
 * which chunks have changed.
 *
 * A voxel is one byte: its state in two bits, above them 1 + the robot that observed it first.
 */
export class VoxelStore {
  constructor(run) {
    this.run = run;
    const { chunks } = run;
    this.inner = chunks.length; // the chunks after them are neighbours, which hold frontiers only
    for (let c = 0; c < this.inner; ++c) this.addNeighbours(c);
    const unknown = new Uint8Array(VOXELS); // one for all neighbours, in which nothing changes
    this.chunks = Array.from({ length: chunks.length }, (_, c) => (c < this.inner ? new Uint8Array(VOXELS) : unknown));
    this.neighbours = new Int32Array(6 * chunks.length);
    for (let c = 0; c < chunks.length; ++c)
      for (let side = 0; side < 6; ++side) this.neighbours[6 * c + side] = this.findNeighbour(c, side);
    this.occupied = new Int32Array(chunks.length); // voxels in each chunk
    this.before = new Uint8Array(run.locals.length); // a voxel before and after each change
    this.after = new Uint8Array(run.locals.length);
    this.dirty = new Uint8Array(chunks.length);
    this.assignment = new Assignment(run);
    this.step = -1; // nothing is known
    for (let s = 0; s < run.steps; ++s) this.learn(s);
    this.measure();
    for (const voxels of this.chunks) voxels.fill(0);
    this.step = -1;
    this.dirty.fill(1);
  }

  addNeighbours(c) {
    const { corners } = this.run.chunks, at = [0, 1, 2].map((k) => corners.items[3 * c + k] / CHUNK);
    for (let axis = 0; axis < 3; ++axis)
      for (const sign of [-1, 1]) {
        const next = [...at];
        next[axis] += sign;
        if (next[axis] >= 0 && next[axis] < 65536 / CHUNK) this.run.chunks.number(...next);
      }
  }

  /** side: 2 * axis, + 1 upwards */
  findNeighbour(c, side) {
    const corner = [0, 1, 2].map((k) => this.run.chunks.corners.items[3 * c + k]);
    corner[side >> 1] += side & 1 ? CHUNK : -CHUNK;
    return corner[side >> 1] < 0 ? -1 : this.run.chunks.find(...corner);
  }

  /** Applies one step and records the voxels before and after its changes. */
  learn(s) {
    const { run } = this;
    for (let r = 0; r < run.robots; ++r) {
      const block = s * run.robots + r;
      for (let g = run.blocks[block]; g < run.blocks[block + 1]; ++g) {
        const voxels = this.chunks[run.groups[g]];
        for (let i = run.begins[g]; i < run.begins[g + 1]; ++i) {
          const old = voxels[run.locals[i]];
          const owner = (old & STATE) === 0 ? r + 1 : old >> 2;
          this.before[i] = old;
          this.after[i] = run.states[i] === 0 ? 0 : run.states[i] | (owner << 2);
          voxels[run.locals[i]] = this.after[i];
        }
      }
    }
    this.step = s;
  }

  /** The box that holds all known voxels of the whole run, as keys. @pre at the last step */
  measure() {
    const low = [65535, 65535, 65535], high = [0, 0, 0], highest = { occupied: 0, lowest: 65535 };
    const corners = this.run.chunks.corners.items;
    for (let c = 0; c < this.inner; ++c)
      for (let l = 0; l < VOXELS; ++l) {
        const state = this.chunks[c][l] & STATE;
        if (state === 0) continue;
        const key = [corners[3 * c] + (l & 31), corners[3 * c + 1] + ((l >> 5) & 31), corners[3 * c + 2] + (l >> 10)];
        for (let k = 0; k < 3; ++k) {
          if (key[k] < low[k]) low[k] = key[k];
          if (key[k] > high[k]) high[k] = key[k];
        }
        if (state === OCCUPIED) {
          if (key[2] > highest.occupied) highest.occupied = key[2];
          if (key[2] < highest.lowest) highest.lowest = key[2];
        }
      }
    this.empty = low[0] > high[0];
    this.low = this.empty ? [32768, 32768, 32768] : low;
    this.high = this.empty ? [32768, 32768, 32768] : high;
    this.heights = highest.occupied < highest.lowest ? [this.low[2], this.high[2]] : [highest.lowest, highest.occupied];
  }

  /** To the end of step s; -1: before the first. */
  seek(s) {
    while (this.step < s) this.go(++this.step, this.after, 1);
    while (this.step > s) this.go(this.step--, this.before, -1);
    this.assignment.seek(s, (x, y, z) => mark(this.dirty, this.run.chunks.find(x, y, z)));
  }

  go(s, bytes, sign) {
    const { run } = this;
    const first = run.blocks[s * run.robots], last = run.blocks[(s + 1) * run.robots] - 1;
    for (let g = sign > 0 ? first : last; g >= first && g <= last; g += sign) this.replace(g, bytes);
  }

  replace(g, bytes) {
    const { run, dirty, neighbours } = this, c = run.groups[g], voxels = this.chunks[c];
    let occupied = 0;
    dirty[c] = 1;
    for (let i = run.begins[g]; i < run.begins[g + 1]; ++i) {
      const l = run.locals[i], old = voxels[l] & STATE, now = bytes[i] & STATE;
      voxels[l] = bytes[i];
      occupied += (now === OCCUPIED) - (old === OCCUPIED);
      const x = l & 31, y = (l >> 5) & 31, z = l >> 10;
      if (x === 0) mark(dirty, neighbours[6 * c]);
      if (x === 31) mark(dirty, neighbours[6 * c + 1]);
      if (y === 0) mark(dirty, neighbours[6 * c + 2]);
      if (y === 31) mark(dirty, neighbours[6 * c + 3]);
      if (z === 0) mark(dirty, neighbours[6 * c + 4]);
      if (z === 31) mark(dirty, neighbours[6 * c + 5]);
    }
    this.occupied[c] += occupied;
  }

  /** The byte of a voxel. */
  at(x, y, z) {
    if (((x | y | z) & ~0xffff) !== 0) return 0;
    const c = this.run.chunks.find(x, y, z);
    return c < 0 ? 0 : this.chunks[c][(x & 31) | ((y & 31) << 5) | ((z & 31) << 10)];
  }

  /** The step at whose end a voxel first was what it is at the end of this one; -1: it never changed. */
  since(x, y, z) {
    const { run } = this, c = run.chunks.find(x, y, z), l = (x & 31) | ((y & 31) << 5) | ((z & 31) << 10);
    for (let s = this.step; s >= 0; --s)
      for (let g = run.blocks[s * run.robots]; g < run.blocks[(s + 1) * run.robots]; ++g) {
        if (run.groups[g] !== c) continue;
        for (let i = run.begins[g]; i < run.begins[g + 1]; ++i) if (run.locals[i] === l) return s;
      }
    return -1;
  }
}

function mark(dirty, c) {
  if (c >= 0) dirty[c] = 1;
}
