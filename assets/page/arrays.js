// Unpacks what src/page/arrays.rs packs: base64, zlib, byte planes, words as what they add to their neighbours.

export function bytesOf(base64) {
  const text = atob(base64);
  const bytes = new Uint8Array(text.length);
  for (let at = 0; at < bytes.length; at++) bytes[at] = text.charCodeAt(at);
  return bytes;
}

export async function inflate(base64) {
  const inflating = new Blob([bytesOf(base64)]).stream().pipeThrough(new DecompressionStream("deflate"));
  return new Uint8Array(await new Response(inflating).arrayBuffer());
}

// A word's lowest bit is its sign; it gets left + above - above left added. The array wraps as the packer's integers do.
function predict(words, row, lanes) {
  for (let at = 0; at < words.length; at++) {
    const hasLeft = at % row >= lanes;
    const left = hasLeft ? words[at - lanes] : 0;
    const above = at < row ? 0 : words[at - row] - (hasLeft ? words[at - row - lanes] : 0);
    words[at] = ((words[at] >>> 1) ^ -(words[at] & 1)) + left + above;
  }
}

// The numbers of a file.
export async function unpack({ word, lanes, width, length, predicted, data }) {
  const planes = await inflate(data);
  const size = word === "u8" ? 1 : 4;
  const words = size === 1 ? new Uint8Array(lanes * length) : new Uint32Array(lanes * length);
  for (let plane = 0, from = 0; plane < lanes * size; plane++) {
    const shift = (plane % size) * 8;
    for (let to = Math.floor(plane / size); to < words.length; to += lanes) words[to] |= planes[from++] << shift;
  }
  if (predicted) predict(words, (width || length) * lanes, lanes);
  return word === "f32" ? new Float32Array(words.buffer) : words;
}
