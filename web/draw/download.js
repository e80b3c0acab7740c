// @ts-check
// What is on the page as files, and as text to paste elsewhere.

import { dress, h } from "./dom.js";
import { withCommas } from "../state/tables.js";

/** Under this name the browser remembers that tables have decimal commas. */
const COMMAS = "meshwright-decimal-commas";

export const hasCommas = () => localStorage.getItem(COMMAS) === "yes";

/** @param {boolean} on */
export const chooseCommas = (on) => (on ? localStorage.setItem(COMMAS, "yes") : localStorage.removeItem(COMMAS));

/**
 * Gives the visitor a file.
 *
 * @type {(name: string, type: string, content: BlobPart) => void}
 */
export function save(name, type, content) {
  const address = URL.createObjectURL(content instanceof Blob ? content : new Blob([content], { type }));
  const link = h("a", { href: address, download: name, hidden: true });
  document.body.append(link);
  link.click();
  link.remove();
  setTimeout(() => URL.revokeObjectURL(address), 10_000);
}

/**
 * Gives the visitor a table of CSV as a file, with the decimals that they have chosen.
 *
 * @type {(name: string, csv: string) => void}
 */
export const saveTable = (name, csv) => save(name, "text/csv", hasCommas() ? withCommas(csv) : csv);

/**
 * A drawing of the page as an element of its own: looks that come from the style sheet are written into it.
 *
 * @type {(svg: SVGSVGElement) => SVGSVGElement}
 */
export function drawingOf(svg) {
  const copy = /** @type {SVGSVGElement} */ (svg.cloneNode(true));
  const [from, to] = [svg.querySelectorAll("*"), copy.querySelectorAll("*")];
  from.forEach((element, i) => {
    const style = getComputedStyle(element);
    if (style.display === "none") to[i].setAttribute("display", "none");
    for (const name of [
      "fill",
      "fill-opacity",
      "stroke",
      "stroke-width",
      "stroke-dasharray",
      "vector-effect",
      "font-family",
      "text-anchor",
      "paint-order",
    ]) {
      const value = style.getPropertyValue(name);
      if ((value && value !== "none") || name === "fill") to[i].setAttribute(name, value);
    }
    for (const name of ["tabindex", "role", "aria-hidden", "data-member"]) to[i].removeAttribute(name);
  });
  const box = svg.viewBox.baseVal;
  const [width, height] = [1200, Math.round((1200 * box.height) / box.width)];
  dress(copy, { xmlns: "http://www.w3.org/2000/svg", width, height });
  return copy;
}

/**
 * Copies `text`, where pages may not use the clipboard too; says whether it did.
 *
 * @type {(text: string) => Promise<boolean>}
 */
export async function copied(text) {
  if (navigator.clipboard) {
    try {
      await navigator.clipboard.writeText(text);
      return true;
    } catch {
      // Not allowed: the old way may be.
    }
  }
  const area = Object.assign(document.createElement("textarea"), { value: text, readOnly: true });
  area.style.cssText = "position: fixed; opacity: 0";
  // Inside an open dialog nothing else can have the focus.
  (document.querySelector("dialog[open]") ?? document.body).append(area);
  const focused = document.activeElement;
  area.select();
  let done = false;
  try {
    done = document.execCommand("copy");
  } catch {
    done = false;
  }
  area.remove();
  if (focused instanceof HTMLElement) focused.focus();
  return done;
}
