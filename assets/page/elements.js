// Elements of the page.

export const byId = (id) => document.getElementById(id);

// An element with attributes and children; text is text, never markup.
export function element(name, attributes = {}, ...children) {
  const isSvg = ["rect", "path", "polygon", "circle", "g"].includes(name);
  const made = isSvg ? document.createElementNS("http://www.w3.org/2000/svg", name) : document.createElement(name);
  for (const [key, value] of Object.entries(attributes)) {
    if (key === "onclick") made.addEventListener("click", value);
    else if (value === true) made.setAttribute(key, "");
    else if (value !== false && value !== null && value !== undefined) made.setAttribute(key, value);
  }
  made.append(...children.flat().filter((child) => child !== null && child !== undefined));
  return made;
}

export const css = ([red, green, blue]) => `rgb(${red} ${green} ${blue})`;

// A patch of a colour beside its name.
export function swatch(color) {
  const made = element("span", { class: "swatch", "aria-hidden": "true" });
  made.style.background = css(color);
  return made;
}

// Buttons of which one is pressed; they stay where they are, and so does the focus.
export function choose(group, options, pressed, onChoose) {
  if (group.children.length !== options.length) {
    group.replaceChildren(...options.map(({ id, name }) =>
      element("button", { type: "button", "data-id": id, onclick: () => onChoose(id) }, name)));
  }
  options.forEach(({ id, isThere, why }, at) => {
    const button = group.children[at];
    button.setAttribute("aria-pressed", String(id === pressed));
    button.disabled = !isThere;
    button.title = isThere ? "" : why;
  });
}

// The options of a select; it is hidden where there is nothing to choose.
export function select(id, options, chosen) {
  const made = byId(id);
  byId(`${id}-of`).hidden = options.length < 2;
  const isSame = made.options.length === options.length && options.every((text, at) => made.options[at].text === text);
  if (!isSame) made.replaceChildren(...options.map((text, at) => element("option", { value: at }, text)));
  made.selectedIndex = chosen;
}
