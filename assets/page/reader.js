// What answers questions about the frame: the program's own code, as WebAssembly (src/page/module.rs).

const written = (text) => new TextEncoder().encode(text);

export class Reader {
  constructor(exports) { this.exports = exports; }

  static async of(module) { return new Reader((await WebAssembly.instantiate(module)).instance.exports); }

  // Puts bytes where the module takes its input from.
  give(...parts) {
    // An address is a number without a sign.
    const start = this.exports.reserve(parts.reduce((sum, { length }) => sum + length, 0)) >>> 0;
    parts.reduce((at, bytes) => {
      new Uint8Array(this.exports.memory.buffer).set(bytes, at);
      return at + bytes.length;
    }, start);
  }

  // What a call has said; null where it said nothing.
  said(length) {
    if (length === 0) return null;
    const bytes = new Uint8Array(this.exports.memory.buffer, this.exports.answer_at() >>> 0, length);
    const answer = JSON.parse(new TextDecoder().decode(bytes));
    if (answer?.error) throw new Error(answer.error);
    return answer;
  }

  // Takes a file of the frame.
  put(name, ...parts) {
    this.give(written(`${name}\n`), ...parts);
    this.said(this.exports.put());
  }

  // Reads the frame, once all its files are there.
  read() { this.said(this.exports.read()); }

  ask(question) {
    this.give(written(JSON.stringify(question)));
    return this.said(this.exports.answer());
  }
}
