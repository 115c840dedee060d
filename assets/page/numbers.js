// Numbers as text, as src/numbers.rs writes them.

// Thousands are apart by a no-break space: `47 425`.
export const count = (value) => String(value).replace(/\B(?=(\d{3})+$)/g, "\u00a0");

// About four digits.
export function digits(value) {
  const size = Math.abs(value);
  if (!Number.isFinite(value)) return value > 0 ? "∞" : String(value);
  if (size === 0) return "0";
  if (size < 1e-3 || size >= 1e5) return value.toExponential(1).replace("+", "");
  if (size < 0.99995) return value.toFixed(4);
  return value.toFixed(size < 99.9995 ? 3 : 1);
}

export const length = (value, unit) => `${digits(value)} ${unit}`;

// A stored depth in the fewest digits that read back as the same bits.
export function depthText(depth) {
  const value = Math.fround(depth);
  if (value === 0 || !Number.isFinite(value)) return String(value);
  let precision = 1;
  while (Math.fround(Number(value.toPrecision(precision))) !== value) precision++;
  const shortest = Number(value.toPrecision(precision));
  if (Math.abs(shortest) < 1e-4) return shortest.toExponential();
  return Number.isInteger(shortest) ? shortest.toFixed(1) : String(shortest);
}

export const lightName = (index) => `light ${index + 1}`;

// A float count with its sign.
export const countInFloat = (value) => (value < 0 ? `−${-value}` : String(value));

// A stencil value as people read it: 255 is `−1 (255)`.
export const signed = (value) => (value < 128 ? String(value) : `−${256 - value} (${value})`);

// The same without the stored byte.
export const signedAlone = (value) => signed(value).split(" ")[0];

export const capitalized = (text) => text.charAt(0).toUpperCase() + text.slice(1);
