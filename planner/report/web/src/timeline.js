import { positionAt } from "./comparison.js";

/**
 * The step that is shown. Sends { step, along } to its listeners: along is the fraction of the paths that the robots have travelled.
 * It plays by the run's clock: `times` holds the time at the end of each step and never falls.
 */
export class Timeline extends EventTarget {
  constructor(times) {
    super();
    this.times = times;
    this.step = Math.max(0, this.steps - 1);
    this.along = 1;
    this.speed = 10; // seconds of the run in a second
    this.playing = false;
    this.tick = (now) => this.advance(now);
  }

  get steps() {
    return this.times.length;
  }

  get position() {
    return { step: this.step, along: this.along };
  }

  /** The clock's time that is shown. */
  get time() {
    const from = this.times[this.step - 1] ?? 0, to = this.times[this.step] ?? 0;
    return this.along === 1 ? to : from + this.along * (to - from);
  }

  reset(times) {
    this.pause();
    this.times = times;
    this.seek(this.steps - 1);
  }

  seek(step) {
    this.step = Math.min(Math.max(step, 0), Math.max(0, this.steps - 1));
    this.along = 1;
    this.notify();
  }

  /** Shows a moment of the clock; of several steps that end then, this one. */
  seekTime(time, step = null) {
    this.pause();
    Object.assign(this, this.times[step] === time ? { step, along: 1 } : positionAt(this.times, time));
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
    const { times } = this, time = this.time + (Math.max(0, now - this.last) / 1000) * this.speed;
    this.last = now;
    while (this.step < this.steps - 1 && time >= times[this.step]) ++this.step;
    const from = times[this.step - 1] ?? 0, lasts = times[this.step] - from;
    this.along = lasts > 0 ? Math.min((time - from) / lasts, 1) : 1;
    if (this.step === this.steps - 1 && this.along >= 1) this.playing = false;
    this.notify();
    if (this.playing) requestAnimationFrame(this.tick);
  }

  notify() {
    this.dispatchEvent(new CustomEvent("change", { detail: this.position }));
  }
}
