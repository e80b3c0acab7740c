// @ts-check
// What belongs to the visitor and not to the design: layout, light or dark, and the key of the service.

import { byId } from "../draw/dom.js";
import { hasKey, onKeyNeeded, setKey, wordsOfRefusedKey } from "../state/api.js";

const THEME = "meshwright-theme";
const LAYOUT = "meshwright-layout";

/**
 * The theme, chosen by the button or by the system; `onTheme` draws anew what has its colors and letters in
 * itself.
 *
 * @param {() => void} onTheme
 */
export function setUpTheme(onTheme) {
  /** @type {(theme: string | null) => void} */
  const apply = (theme) => {
    if (theme) document.documentElement.dataset.theme = theme;
    onTheme();
  };
  apply(localStorage.getItem(THEME));
  byId("theme-button").addEventListener("click", () => {
    const other = getComputedStyle(document.documentElement).colorScheme === "dark" ? "light" : "dark";
    localStorage.setItem(THEME, other);
    apply(other);
  });
  // The size of letters changes at the widest screens, as style.css says.
  for (const query of ["(prefers-color-scheme: dark)", "(min-width: 180rem)"])
    matchMedia(query).addEventListener("change", () => apply(null));
}

/** The layouts in which both gears of the design stand side by side, with every section open. */
const SHEETS = ["sheet", "sheet-alone"];

/**
 * The layout of the page: the design as a form or as a data sheet, beside the answers or alone. `onSheet` hears whether
 * it is a data sheet.
 *
 * @param {(isSheet: boolean) => void} onSheet
 */
export function setUpLayout(onSheet) {
  const choice = byId("layout", HTMLSelectElement);
  const apply = () => {
    document.body.dataset.layout = choice.value;
    onSheet(SHEETS.includes(choice.value));
  };
  const before = localStorage.getItem(LAYOUT);
  if (before && [...choice.options].some(({ value }) => value === before)) choice.value = before;
  choice.addEventListener("change", () => {
    localStorage.setItem(LAYOUT, choice.value);
    apply();
  });
  apply();
}

/**
 * The key, asked for by the service or given by the button; `onKey` asks again for what was refused.
 *
 * @param {() => void} onKey
 */
export function setUpKey(onKey) {
  const dialog = byId("key-dialog", HTMLDialogElement);
  const input = byId("key", HTMLInputElement);
  const ask = (words = "") => {
    byId("key-error").textContent = words;
    if (!dialog.open) dialog.showModal();
  };
  byId("key-button").addEventListener("click", () => ask(byId("key-error").textContent ?? ""));
  onKeyNeeded(({ detail }) => {
    const words = hasKey() ? wordsOfRefusedKey(detail) : "";
    // Who types goes on typing: what is wrong stands above the curves, with the way to this dialog.
    if (!document.activeElement?.matches("input, select, textarea") || dialog.open) ask(words);
    else byId("key-error").textContent = words;
  });
  byId("key-form").addEventListener("submit", ({ submitter }) => {
    if (!(submitter instanceof HTMLButtonElement) || submitter.value !== "use") return;
    setKey(input.value);
    input.value = "";
    byId("key-error").textContent = "";
    onKey();
  });
}
