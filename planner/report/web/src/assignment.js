/** Whose each frontier is to look at: a bit for each robot, for the voxels that have any. */
export class Assignment {
  constructor(run) {
    this.run = run;
    this.masks = new Map();
    this.step = -1;
  }

  /** To the end of step s. @param changed is called with the x, y, z of each voxel that has changed hands */
  seek(s, changed) {
    while (this.step < s) this.turn(++this.step, changed);
    while (this.step > s) this.turn(this.step--, changed);
  }

  /** What a step gives to a robot it takes back when turned again. */
  turn(s, changed) {
    const { run, masks } = this;
    for (let r = 0; r < run.robots; ++r) {
      const [x, y, z] = run.reassigned[s * run.robots + r];
      for (let i = 0; i < x.length; ++i) {
        const name = nameOf(x[i], y[i], z[i]), mask = (masks.get(name) ?? 0) ^ (1 << r);
        if (mask === 0) masks.delete(name);
        else masks.set(name, mask);
        changed(x[i], y[i], z[i]);
      }
    }
  }

  /** 1 + the robot whose frontier a voxel is; 0 if it is nobody's or that of several. */
  ownerOf(x, y, z) {
    const mask = this.masks.get(nameOf(x, y, z)) ?? 0;
    return mask !== 0 && (mask & (mask - 1)) === 0 ? 32 - Math.clz32(mask) : 0;
  }
}

const nameOf = (x, y, z) => (x * 65536 + y) * 65536 + z;
