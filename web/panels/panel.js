// @ts-check
// The panels under the tabs, and those of them that ask for many designs: one question at a time, how far it is, why it
// was refused, and of which design its answer is.

import { button, h } from "../draw/dom.js";
import { follow, hasEnded, json, post, ProblemError, request } from "../state/api.js";
import { apart, same, withValue } from "../state/design.js";
import { remaining } from "../state/numbers.js";
import { quantityOf, worstInRow } from "../state/quantities.js";
import { begin, kindOf, submitted } from "../state/work.js";

/** @import { Design } from "../state/design.js" */
/** @import { AskedStudy, StudyResults, StudyState, Submission } from "../state/documents.js" */

/** A panel under a tab: it is renewed when the tab is chosen, and told when the tab is left. */
export class Panel {
  /** @param {HTMLElement} place */
  constructor(place) {
    this.place = place;
  }

  /** @returns {unknown} */
  refresh() {
    return undefined;
  }

  /** Nobody looks any more. */
  leave() {}
}

/**
 * A panel that asks for a study of the design, and shows its answer while it comes.
 *
 * @template {{ status: string, done: number, total?: number }} F what is fetched of the study: its `part`
 */
export class StudyPanel extends Panel {
  /** The part of the study that is shown, and how often it is fetched at most while the study runs, in milliseconds. */
  part = "/results";
  pause = 400;
  /**
   * What came last, and the address of its study.
   *
   * @type {{ found: F, address: string } | null}
   */
  last = null;
  /**
   * The study that was asked for.
   *
   * @type {AskedStudy | null}
   */
  about = null;
  /**
   * The design that the answer is of.
   *
   * @type {Submission | null}
   */
  #of = null;
  #cancel = () => {};

  /**
   * A panel of `design` in `place`: its button says `words`, and `id` begins what its parts are called; `inWords` puts
   * what the service says into the words of the page; answers do not depend on the fields `ignored`.
   *
   * @param {HTMLElement} place
   * @param {Design} design
   * @param {{ id: string, words: string, inWords?: (detail: string) => string, ignored?: string[] }} how
   */
  constructor(place, design, { id, words, inWords = (detail) => detail, ignored = [] }) {
    super(place);
    this.design = design;
    this.inWords = inWords;
    this.ignored = ignored;
    this.run = h("button", { type: "submit", id: `${id}-run`, className: "primary" }, words);
    this.cancel = button("Cancel", () => this.#cancel(), { hidden: true });
    this.state = h("p", { className: "note", role: "status", id: `${id}-state` });
    this.outdated = h(
      "p",
      { className: "note outdated", role: "status", hidden: true },
      "The design has changed since: what stands below is of the one before. ",
      button("Go back to that design", () => this.#of && design.replace(this.#of, "open")),
    );
    this.out = h("div", { className: "out", id: `${id}-out` });
    design.onChange(() => this.#lookWhetherOutdated());
  }

  /**
   * The study that the button asks for; throws what keeps it from being asked for.
   *
   * @abstract
   * @returns {AskedStudy}
   */
  asked() {
    throw new Error(`${this.constructor.name} asks for nothing`);
  }

  /**
   * Shows what came last.
   *
   * @abstract
   * @param {F} _found
   * @param {string} _address that of the study
   */
  show(_found, _address) {}

  /**
   * How far the study is, in words.
   *
   * @param {number} done
   * @param {number} total
   * @param {(done: number, total: number) => string} left
   */
  progress(done, total, left) {
    return `${done} of ${total} designs${left(done, total)}`;
  }

  /**
   * How the study ended, in words.
   *
   * @param {F} found
   * @returns {string}
   */
  ended({ done, total, status }) {
    return `${done} of ${total} designs, ${status}`;
  }

  /** Takes the answer before away. */
  clear() {
    this.last = null;
    this.out.replaceChildren();
  }

  /** @returns {Promise<void>} */
  async start() {
    this.clear();
    await this.#ask(async () => {
      const study = (this.about = this.asked());
      const made = await post("v1/studies", study);
      submitted({ id: made.id, kind: kindOf(study), name: study.name ?? "", at: made.submitted_at });
      await this.#watch(made);
    }, this.design.submission);
  }

  /**
   * Shows a study that was asked for before.
   *
   * @param {string} id
   * @param {AskedStudy} about
   * @returns {Promise<void>}
   */
  async resume(id, about) {
    this.clear();
    this.about = about;
    await this.#ask(async () => this.#watch(await json(`v1/studies/${id}`)), about.base);
  }

  /** @param {string} words */
  say(words) {
    this.state.textContent = words;
  }

  /**
   * Does `work` on a design; nothing else is asked meanwhile, and a refusal is told.
   *
   * @param {() => Promise<void>} work
   * @param {Submission} submission
   */
  async #ask(work, submission) {
    this.run.disabled = true;
    this.#of = submission;
    this.#lookWhetherOutdated();
    try {
      await work();
    } catch (error) {
      if (!(error instanceof ProblemError)) throw error;
      const details = error.problem.errors?.map(({ detail }) => detail) ?? [];
      this.state.replaceChildren(
        ...(details.length ? details : [error.message]).map((detail) =>
          h("span", { className: "field-error" }, this.inWords(detail), " "),
        ),
      );
    } finally {
      this.run.disabled = false;
      this.cancel.hidden = true;
    }
  }

  /** @param {StudyState} made */
  async #watch(made) {
    const address = `v1/studies/${made.id}`;
    const goesOn = !hasEnded(made.status);
    const cancel = () => request(`${address}/cancel`, { method: "POST" }).catch(() => {});
    if (goesOn) {
      this.#cancel = cancel;
      this.cancel.hidden = false;
    }
    const work = begin(made.name ?? "", cancel, { id: made.id, seconds: made.estimate?.seconds ?? null });
    const left = remaining();
    let [shown, whole] = [performance.now(), false];
    /** @param {F} found */
    const came = (found) => {
      this.last = { found, address };
      this.show(found, address);
    };
    /** @type {(event: string, data: { done?: number, total?: number }) => void} */
    const told = (event, { done = 0, total }) => {
      if (event === "away") this.say("The service does not answer; it is asked again until it does.");
      if (total) {
        const said = this.progress(done, total, left);
        this.say(said);
        work.tell({ share: done / total, said });
      }
      if (performance.now() - shown < this.pause) return;
      shown = performance.now();
      json(address + this.part).then(
        (found) => whole || came(found),
        () => {},
      );
    };
    try {
      const { status } = goesOn ? await follow(address, told) : made;
      const found = await json(address + this.part);
      whole = true;
      work.end(status);
      came(found);
      this.say(this.ended(found));
    } finally {
      work.end();
    }
  }

  #lookWhetherOutdated() {
    this.outdated.hidden = this.#of === null || this.isOf(this.design.submission);
  }

  /**
   * Whether the answers are those of a design.
   *
   * @param {Submission} submission
   */
  isOf(submission) {
    /** @type {(submission: Submission) => Submission} */
    const bare = (submission) =>
      this.ignored.reduce((rest, pointer) => withValue(rest, pointer, undefined), apart(submission).curves);
    return this.#of !== null && same(bare(this.#of), bare(submission));
  }
}

/**
 * Offers in `select` the quantities alone that the rows of a study tell, and gives these rows.
 *
 * @type {(select: HTMLSelectElement, results: StudyResults) => StudyResults["rows"]}
 */
export function offerTold(select, { rows, gear }) {
  const computed = rows.filter((row) => row.curves?.length);
  for (const option of select.options)
    option.hidden = !computed.some((row) => Number.isFinite(worstInRow(quantityOf(option.value), row, gear)));
  return computed;
}

/**
 * Why most of those failed that did, behind how many: `refusals` are as the service has them, the most common first;
 * `inWords` puts what they say into the words of the page.
 *
 * @type {(refusals: { detail: string }[], inWords: (detail: string) => string) => string}
 */
export const mostOften = ([first], inWords) =>
  first ? `, most often: ${inWords(first.detail).replace(/\.$/, "")}` : "";
