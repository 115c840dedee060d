// Unpacks what src/page/arrays.rs packs: base64, zlib, byte planes, and words that stand for what they
// add to their neighbours.

const WORDS = { u8: Uint8Array, u32: Uint32Array, f32: Float32Array };

function bytesOf(base64) {
  const text = atob(base64);
  const bytes = new Uint8Array(text.length);
  for (let at = 0; at < bytes.length; at++) bytes[at] = text.charCodeAt(at);
  return bytes;
}

async function inflated(bytes) {
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate"));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

// Joins the planes of each lane's first bytes, second bytes, and so on.
function joined(planes, size, lanes, length) {
  const bytes = new Uint8Array(planes.length);
  for (let lane = 0; lane < lanes; lane++) {
    for (let byte = 0; byte < size; byte++) {
      let from = (lane * size + byte) * length;
      for (let to = lane * size + byte; to < bytes.length; to += lanes * size) bytes[to] = planes[from++];
    }
  }
  return bytes;
}

// Each word gets left + above - above left added; the typed array wraps as the packer's integers do.
function predict(words, row, lanes) {
  for (let at = 0; at < words.length; at++) {
    const hasLeft = at % row >= lanes;
    const left = hasLeft ? words[at - lanes] : 0;
    if (at < row) words[at] += left;
    else words[at] += left + words[at - row] - (hasLeft ? words[at - row - lanes] : 0);
  }
}

export async function unpack({ word, lanes, width, length, predicted, data }) {
  const size = word === "u8" ? 1 : 4;
  const bytes = joined(await inflated(bytesOf(data)), size, lanes, length);
  const words = size === 1 ? bytes : new Uint32Array(bytes.buffer);
  if (predicted) predict(words, (width || length) * lanes, lanes);
  return new WORDS[word](bytes.buffer);
}
