// @ts-check
// Which design an answer is of, where that design may change while the answer stands.

import { button, h } from "../draw/dom.js";
import { apart, same, withValue } from "../state/design.js";

/** @import { Design } from "../state/design.js" */
/** @import { Submission } from "../state/documents.js" */

/**
 * A line over an answer of `design` that appears once the design is another one than the one asked about. `ignored` are
 * fields that the answer does not depend on.
 *
 * @param {Design} design
 * @param {string[]} ignored
 */
export function outdated(design, ignored = []) {
  /** @type {Submission | null} */
  let asked = null;
  /** @type {(submission: Submission) => Submission} */
  const bare = (submission) =>
    ignored.reduce((rest, pointer) => withValue(rest, pointer, undefined), apart(submission).curves);
  const back = button("Go back to that design", () => asked && design.replace(asked, "open"));
  const element = h(
    "p",
    { className: "note outdated", role: "status", hidden: true },
    "The design has changed since: what stands below is of the one before. ",
    back,
  );
  const look = () => {
    element.hidden = asked === null || same(bare(asked), bare(design.submission));
  };
  design.onChange(look);
  return {
    element,
    /** What stands below is of this design: the one as it is now, or an earlier one. */
    renew(submission = design.submission) {
      asked = submission;
      look();
    },
  };
}
