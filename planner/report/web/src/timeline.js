/** The step that is shown. Sends { step, along } to its listeners: along is the fraction of the paths that the robots have travelled. */
export class Timeline extends EventTarget {
  constructor(steps) {
    super();
    this.steps = steps;
    this.step = Math.max(0, steps - 1);
    this.along = 1;
    this.speed = 2; // steps a second
    this.playing = false;
    this.tick = (now) => this.advance(now);
  }

  get position() {
    return { step: this.step, along: this.along };
  }

  reset(steps) {
    this.pause();
    this.steps = steps;
    this.seek(steps - 1);
  }

  seek(step) {
    this.step = Math.min(Math.max(step, 0), Math.max(0, this.steps - 1));
    this.along = 1;
    this.notify();
  }

  move(by) {
    this.pause();
    this.seek(this.step + by);
  }

  toggle() {
    if (this.playing) return this.pause();
    if (this.steps === 0) return;
    if (this.step >= this.steps - 1 && this.along >= 1) {
      this.step = 0;
      this.along = 0;
    }
    this.playing = true;
    this.last = performance.now();
    this.notify();
    requestAnimationFrame(this.tick);
  }

  pause() {
    if (!this.playing) return;
    this.playing = false;
    this.along = 1;
    this.notify();
  }

  advance(now) {
    if (!this.playing) return;
    let along = this.along + (Math.max(0, now - this.last) / 1000) * this.speed;
    this.last = now;
    while (along >= 1 && this.step < this.steps - 1) {
      ++this.step;
      along -= 1;
    }
    this.along = Math.min(along, 1);
    if (along >= 1) this.playing = false;
    this.notify();
    if (this.playing) requestAnimationFrame(this.tick);
  }

  notify() {
    this.dispatchEvent(new CustomEvent("change", { detail: this.position }));
  }
}
