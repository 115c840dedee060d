(() => {
  // WCAG 2's contrast of each text with the nearest opaque ground behind it; those below 4.5 are poor.
  const luminance = (color) => {
    const linear = color.map((byte) => (byte / 255 <= 0.04045 ? byte / 255 / 12.92 : ((byte / 255 + 0.055) / 1.055) ** 2.4));
    return 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2];
  };
  const numbers = (text) => (text.match(/[0-9.]+/g) ?? []).map(Number);
  const ground = (element) => {
    for (let one = element; one; one = one.parentElement) {
      const [red, green, blue, alpha = 1] = numbers(getComputedStyle(one).backgroundColor);
      if (alpha === 1) return [red, green, blue];
    }
    return [255, 255, 255];
  };
  const poor = [];
  const texts = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
  while (texts.nextNode()) {
    const element = texts.currentNode.parentElement;
    const isText = texts.currentNode.textContent.trim() !== "" && !["SCRIPT", "NOSCRIPT", "STYLE", "OPTION"].includes(element.tagName);
    if (!isText || !element.checkVisibility() || element.closest(":disabled")) continue;
    const [a, b] = [numbers(getComputedStyle(element).color).slice(0, 3), ground(element)].map(luminance);
    const contrast = (Math.max(a, b) + 0.05) / (Math.min(a, b) + 0.05);
    if (contrast < 4.5) poor.push(`${contrast.toFixed(2)}: ${texts.currentNode.textContent.trim().slice(0, 40)} (${element.className})`);
  }
  return [...new Set(poor)].slice(0, 20);
})()
