// @ts-check
// What else has happened, said for a while with a way back.

import { button } from "../draw/dom.js";

/** @import { Design } from "../state/design.js" */

/** So long a notice is shown, in milliseconds, once it offers no way back. */
const TIME = 12_000;

export class Notice {
  /** @type {number | undefined} */
  #timer;

  /**
   * @param {HTMLElement} place
   * @param {Design} design
   */
  constructor(place, design) {
    this.place = place;
    this.design = design;
    // The way back that a notice offers is from the change that it tells of.
    design.onChange(() => {
      const undo = place.querySelector(".undo");
      if (!undo) return;
      this.#fade();
      undo.remove();
    });
  }

  /** @param {string} words */
  say(words, undoable = true) {
    const close = () => (this.place.hidden = true);
    const undo = () => {
      this.design.undo();
      close();
    };
    this.place.replaceChildren(
      words,
      " ",
      ...(undoable ? [button("Undo", undo, { className: "undo" })] : []),
      button("×", close, { ariaLabel: "Close the notice" }),
    );
    this.place.hidden = false;
    if (undoable) clearTimeout(this.#timer);
    else this.#fade();
  }

  /** What a notice tells of stays until something else has been changed, and a while longer. */
  #fade() {
    clearTimeout(this.#timer);
    this.#timer = setTimeout(() => {
      this.place.hidden = true;
    }, TIME);
  }
}
