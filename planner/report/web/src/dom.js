/**
 * Makes an element. `text` is text, whatever it holds; `on` names listeners; the rest are attributes, left out
 * if they are false or undefined.
 */
export function el(tag, properties = {}, ...children) {
  const element = document.createElement(tag);
  for (const [name, value] of Object.entries(properties)) {
    if (name === "text") element.textContent = value;
    else if (name === "on") for (const [event, listener] of Object.entries(value)) element.addEventListener(event, listener);
    else if (value !== false && value !== undefined) element.setAttribute(name, value === true ? "" : value);
  }
  element.append(...children.filter((child) => child !== null && child !== undefined));
  return element;
}

/**
 * A coloured mark of a legend; the colour is set as a property, which the content policy allows.
 * @param dash of a dashed line: lengths of dashes and gaps in turn [px]
 */
export function swatch(color, kind = "", dash = []) {
  const mark = el("span", { class: `swatch ${kind}`, "aria-hidden": "true" });
  mark.style.background = color;
  if (dash.length > 0) {
    let from = 0;
    const parts = dash.map((length, i) => `${i % 2 === 0 ? "#000" : "transparent"} ${from}px ${(from += length)}px`);
    mark.style.mask = `repeating-linear-gradient(to right, ${parts.join(", ")})`;
  }
  return mark;
}

/** A table with a caption, a row of heads, and rows whose first cell is a head. */
export function table(caption, heads, rows) {
  const td = (text) => el("td", { class: text.length > 16 && "sentence", text });
  return el("div", { class: "table-scroll", tabindex: 0, role: "region", "aria-label": caption }, el("table", {},
    el("caption", { text: caption }),
    heads.length > 0 ? el("thead", {}, el("tr", {}, ...heads.map((text) => el("th", { scope: "col", text })))) : null,
    el("tbody", {}, ...rows.map((row) => el("tr", {}, ...row.map((cell, i) => (i === 0 ? el("th", { scope: "row", text: String(cell) }) : td(String(cell)))))))));
}
