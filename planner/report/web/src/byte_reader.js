/** Reads what src/run_data.cpp wrote. Throws a RangeError where the bytes end too early. */
export class ByteReader {
  constructor(bytes, at = 0) {
    this.bytes = bytes;
    this.at = at;
    this.view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
  }

  u8() {
    if (this.at >= this.bytes.length) throw new RangeError("the data of the run end too early");
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

  difference() {
    const number = this.count();
    return number % 2 === 0 ? number / 2 : -(number + 1) / 2;
  }

  f32() {
    const number = this.view.getFloat32(this.at, true);
    this.at += 4;
    return number;
  }

  /** The next bytes, not copied. */
  take(length) {
    if (this.at + length > this.bytes.length) throw new RangeError("the data of the run end too early");
    this.at += length;
    return this.bytes.subarray(this.at - length, this.at);
  }
}
