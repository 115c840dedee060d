// Elements of the page.

export const byId = (id) => document.getElementById(id);
// An element with attributes and children; text is text, never markup.
export function element(name, attributes = {}, ...children) {
  const space = ["path", "polygon"].includes(name) ? "2000/svg" : "1999/xhtml";
  const made = document.createElementNS(`http://www.w3.org/${space}`, name);
  for (const [key, value] of Object.entries(attributes)) {
    if (key === "onclick") made.addEventListener("click", value);
    else if ((value ?? false) !== false) made.setAttribute(key, value === true ? "" : value);
  }
  made.append(...children.flat(2).filter((child) => child !== null && child !== undefined));
  return made;
}

export const css = ([red, green, blue]) => `rgb(${red} ${green} ${blue})`;

// A patch of a colour beside its name.
export function swatch(color) {
  const made = element("span", { class: "swatch", "aria-hidden": "true" });
  made.style.background = css(color);
  return made;
}

// The sign of a part of the frame's geometry beside its name.
export const partSign = (part) => element("span", { class: `part ${part}`, "aria-hidden": "true" });
export const button = (attributes, ...children) => element("button", { type: "button", ...attributes }, ...children);

// A table with names over its columns.
export function table(names, rows, caption = null) {
  const head = names.map((name) => element("th", { scope: "col" }, name));
  const title = caption && element("caption", {}, caption);
  return element("table", {}, title, element("thead", {}, element("tr", {}, head)), element("tbody", {}, rows));
}

const cellOf = (cell) => (cell instanceof Element ? cell : element("td", {}, cell));
export const row = (attributes, ...cells) => element("tr", attributes, cells.map(cellOf));

// Buttons of which one is pressed; they stay where they are, and so does the focus.
export function choose(group, options, pressed, onChoose) {
  if (group.children.length !== options.length) {
    group.replaceChildren(...options.map(({ id, name }) => button({ "data-id": id, onclick: () => onChoose(id) }, name)));
  }
  options.forEach(({ id, why }, at) => {
    const one = group.children[at];
    one.setAttribute("aria-pressed", String(id === pressed));
    one.disabled = why !== null;
    one.title = why ?? "";
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
