// @ts-check
// Elements.

/** @typedef {string | Node | null | undefined} Child */

/**
 * The listeners of an element: what happens to it is told with the element itself as its `target`.
 *
 * @template {Element} E
 * @typedef {{ [N in keyof HTMLElementEventMap]?:
 *   (event: HTMLElementEventMap[N] & { target: E, currentTarget: E }) => unknown }} Listeners
 */

/**
 * Properties of an element by their names, or attributes where it has no such property; `on` holds its listeners,
 * `data` its data attributes, `aria` its ARIA attributes.
 *
 * @template {Element} E
 * @typedef {{ [name: string]: unknown, on?: Listeners<E>, data?: Record<string, string>,
 *   aria?: Record<string, string | number> }} Properties
 */

/**
 * An element with properties and children.
 *
 * @template {keyof HTMLElementTagNameMap} T
 * @param {T} tag
 * @param {Properties<HTMLElementTagNameMap[T]>} [properties]
 * @param {(Child | Child[])[]} children
 */
export function h(tag, properties = {}, ...children) {
  const element = document.createElement(tag);
  const { on = {}, data = {}, aria = {}, ...rest } = properties;
  for (const [name, value] of Object.entries(rest)) {
    if (value === undefined || value === null) continue;
    if (name in element && name !== "list") Object.assign(element, { [name]: value });
    else element.setAttribute(name, String(value));
  }
  for (const [name, value] of Object.entries(data)) element.dataset[name] = value;
  for (const [name, value] of Object.entries(aria)) element.setAttribute(`aria-${name}`, String(value));
  for (const [name, listener] of Object.entries(on)) {
    element.addEventListener(name, /** @type {EventListener} */ (/** @type {unknown} */ (listener)));
  }
  element.append(...children.flat().filter((child) => child !== null && child !== undefined));
  return element;
}

/**
 * A button that says `words` and does `click`.
 *
 * @param {Child} words
 * @param {Listeners<HTMLButtonElement>["click"]} click
 * @param {Properties<HTMLButtonElement>} [more]
 */
export const button = (words, click, { on, ...more } = {}) =>
  h("button", { type: "button", ...more, on: { ...on, click } }, words);

/**
 * A button with a sign on it, which is named by `label`.
 *
 * @param {string} sign
 * @param {string} label
 * @param {() => void} click
 */
export const signButton = (sign, label, click) => button(sign, click, { ariaLabel: label, title: label });

/**
 * What is said beside controls and pictures.
 *
 * @param {(Child | Child[])[]} children
 */
export const note = (...children) => h("p", { className: "note" }, ...children);

/**
 * Controls and words in a line.
 *
 * @param {(Child | Child[])[]} children
 */
export const inLine = (...children) => h("div", { className: "line" }, ...children);

/**
 * A control behind its label.
 *
 * @template {HTMLElement} E
 * @param {Child} words
 * @param {E} control
 * @returns {[HTMLLabelElement, E]}
 */
export const labelled = (words, control) => [h("label", { htmlFor: control.id }, words), control];

/**
 * A control for a number between its label and its unit, which stay in one line.
 *
 * @param {Child} words
 * @param {HTMLElement} control
 * @param {string} unit
 */
export const measured = (words, control, unit) =>
  h("span", { className: "measured" }, ...labelled(words, control), h("span", { className: "unit" }, unit));

/**
 * What may be wider than its place and is scrolled there, by keys too.
 *
 * @param {string} ariaLabel
 * @param {(Child | Child[])[]} children
 */
export const region = (ariaLabel, ...children) =>
  h("div", { className: "scroll", tabIndex: 0, role: "region", ariaLabel }, ...children);

/**
 * What those alone hear who do not see.
 *
 * @param {string} words
 */
export const unseen = (words) => h("span", { className: "visually-hidden" }, words);

/**
 * A row of a table: what it is of, and its cells.
 *
 * @param {Child} of
 * @param {(Child | Child[])[]} cells
 */
export const tableRow = (of, ...cells) =>
  h("tr", {}, h("th", { scope: "row" }, of), ...cells.map((cell) => h("td", {}, cell)));

/**
 * A table of these rows below the names of its columns.
 *
 * @param {Child[]} names
 * @param {HTMLTableRowElement[]} rows
 * @param {string | null} [caption]
 */
export const table = (names, rows, caption = null) =>
  h(
    "table",
    {},
    caption && h("caption", {}, caption),
    h("thead", {}, h("tr", {}, ...names.map((name) => h("th", { scope: "col" }, name)))),
    h("tbody", {}, ...rows),
  );

/**
 * A form whose answer is computed by `ask`, and which is not sent.
 *
 * @param {() => void} ask
 * @param {(Child | Child[])[]} children
 */
export function asking(ask, ...children) {
  /** @type {(event: SubmitEvent) => void} */
  const submit = (event) => {
    event.preventDefault();
    ask();
  };
  return h("form", { on: { submit } }, ...children);
}

/**
 * An element of a drawing; all its properties are attributes.
 *
 * @template {keyof SVGElementTagNameMap} T
 * @param {T} tag
 * @param {Record<string, string | number | null | undefined>} [attributes]
 * @param {(string | Node)[]} children
 */
export function s(tag, attributes = {}, ...children) {
  const element = document.createElementNS("http://www.w3.org/2000/svg", tag);
  dress(element, attributes);
  element.append(...children);
  return element;
}

/**
 * Gives an element attributes.
 *
 * @param {Element} element
 * @param {Record<string, string | number | null | undefined>} attributes
 */
export function dress(element, attributes) {
  for (const [name, value] of Object.entries(attributes)) {
    if (value !== undefined && value !== null) element.setAttribute(name, String(value));
  }
}

/**
 * The element of the page with this id, of a kind that it is known to have.
 *
 * @template {HTMLElement} [E=HTMLElement]
 * @param {string} id
 * @param {(new () => E) | typeof HTMLElement} [kind]
 */
export function byId(id, kind = HTMLElement) {
  const element = document.getElementById(id);
  if (!(element instanceof kind)) throw new Error(`the page has no ${id}`);
  return /** @type {E} */ (element);
}

/**
 * The first element within `place` that `selector` finds, of a kind that the page knows to be there.
 *
 * @template {Element} E
 * @param {ParentNode} place
 * @param {string} selector
 * @param {new () => E} kind
 */
export function within(place, selector, kind) {
  const element = place.querySelector(selector);
  if (!(element instanceof kind)) throw new Error(`the page has no ${selector}`);
  return element;
}

/**
 * Calls `work` with the last arguments, `wait` milliseconds after the last call.
 *
 * @template {unknown[]} P
 * @param {number} wait
 * @param {(...parameters: P) => void} work
 */
export function debounced(wait, work) {
  /** @type {number | undefined} */
  let timer;
  /** @param {P} parameters */
  return (...parameters) => {
    clearTimeout(timer);
    timer = setTimeout(() => work(...parameters), wait);
  };
}

/**
 * What an element is folded away in.
 *
 * @type {(element: HTMLElement) => HTMLDetailsElement[]}
 */
export function around(element) {
  const parent = element.closest("details");
  return parent ? [parent, ...(parent.parentElement ? around(parent.parentElement) : [])] : [];
}

/**
 * Shows words or hides them, and tells the button for it.
 *
 * @type {(button: HTMLElement, words: HTMLElement) => void}
 */
export function toggle(button, words) {
  words.hidden = !words.hidden;
  button.setAttribute("aria-expanded", String(!words.hidden));
}
