// @ts-check
// Numbers that are turned by hand: by arrow keys in their control, and by dragging their name sideways.

import { put } from "../draw/inputs.js";
import { stepped, turned } from "../state/typed.js";

/** @import { Changes } from "../state/changes.js" */
/** @import { Kind } from "../state/schema.js" */

/**
 * Arrow keys turn the last digit of a number, and with Shift the one before.
 *
 * @param {KeyboardEvent} event
 * @param {string} pointer
 * @param {Kind} kind
 * @param {Changes} changes
 */
export function turnByKey(event, pointer, kind, changes) {
  const sign = { ArrowUp: 1, ArrowDown: -1 }[event.key];
  const value = changes.design.get(pointer) ?? kind.schema.default;
  const input = event.target;
  if (!sign || typeof value !== "number" || !(input instanceof HTMLInputElement)) return;
  event.preventDefault();
  const text = turned(input.value, value, sign * (event.shiftKey ? 10 : 1), kind);
  changes.turn(pointer, Number(text));
  // A zero at its end is the digit that is turned next.
  put(input, text);
}

/**
 * The name of a number is dragged sideways to change it.
 *
 * @param {HTMLElement} label
 * @param {string} pointer
 * @param {Kind} kind
 * @param {Changes} changes
 */
export function turnByName(label, pointer, kind, changes) {
  label.classList.add("scrub");
  label.addEventListener("pointerdown", (event) => {
    const value = changes.design.get(pointer) ?? kind.schema.default;
    if (event.button !== 0 || typeof value !== "number") return;
    let begun = false;
    /** @type {(moved: PointerEvent) => void} */
    const move = (moved) => {
      const by = Math.round((moved.clientX - event.clientX) / 4);
      if (!begun && Math.abs(by) < 1) return;
      if (!begun) changes.design.hold();
      begun = true;
      changes.turn(pointer, stepped(value, by, kind));
    };
    label.setPointerCapture(event.pointerId);
    label.addEventListener("pointermove", move);
    const end = () => {
      label.removeEventListener("pointermove", move);
      if (begun) changes.design.release();
    };
    for (const name of ["pointerup", "pointercancel"]) label.addEventListener(name, end, { once: true });
  });
}
