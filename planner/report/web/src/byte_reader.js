/** What is wrong with the data of a run; the message is for the reader of the page. */
export class RunError extends Error {}

export const damaged = (what) => new RunError(`the data of the run are damaged: ${what}. Make it again with frontlux report.`);

/** Reads what src/run_data.cpp wrote. Throws a RunError where the bytes end too early. */
export class ByteReader {
  constructor(bytes) {
    this.bytes = bytes;
    this.at = 0;
    this.view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
  }

  /** Throws unless there are so many elements of at least so many bytes each. */
  need(elements, size = 1) {
    if (!(elements * size <= this.bytes.length - this.at)) throw damaged("they end too early");
  }

  u8() {
    this.need(1);
    return this.bytes[this.at++];
  }

  count() {
    let byte = this.u8();
    if (byte < 0x80) return byte;
    let number = byte & 0x7f;
    for (let scale = 128; byte >= 0x80; scale *= 128) {
      byte = this.u8();
      number += (byte & 0x7f) * scale;
    }
    return number;
  }

  /** A count from 0 to below `end`. */
  below(end, what) {
    const number = this.count();
    if (!(number < end)) throw damaged(`${what} is ${number}`);
    return number;
  }

  difference() {
    const number = this.count();
    return number % 2 === 0 ? number / 2 : -(number + 1) / 2;
  }

  u32() {
    this.need(4);
    const number = this.view.getUint32(this.at, true);
    this.at += 4;
    return number;
  }

  f32() {
    this.need(4);
    const number = this.view.getFloat32(this.at, true);
    this.at += 4;
    return number;
  }

  /** The next bytes, not copied. */
  take(length) {
    this.need(length);
    this.at += length;
    return this.bytes.subarray(this.at - length, this.at);
  }
}
