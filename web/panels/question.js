// @ts-check
// What the panels share that ask for many designs: one question at a time, how far it is, why it was refused, and of
// which design its answer is.

import { button, h } from "../draw/dom.js";
import { outdated } from "./outdated.js";
import { follow, hasEnded, json, post, ProblemError, request } from "../state/api.js";
import { remaining } from "../state/numbers.js";
import { begin, kindOf, submitted } from "../state/work.js";

/** @import { Design } from "../state/design.js" */
/** @import { StudyState, Submission } from "../state/documents.js" */
/** @import { Asked } from "../state/work.js" */

/**
 * How a study is followed: `show` is given what `part` of it tells, once in `pause` milliseconds at most, and its
 * address; `progress` says how far it is, and `ended` how it ended.
 *
 * @template F what `part` tells
 * @typedef {object} Watching
 * @property {string} [part]
 * @property {number} pause
 * @property {(done: number, total: number, left: (done: number, total: number) => string) => string} progress
 * @property {(found: F, address: string) => void} show
 * @property {(found: F) => string} ended
 */

export class Question {
  #cancel = () => {};

  /**
   * A question about `design`: its button says `words`, and `id` begins what its parts are called; `inWords` puts what
   * the service says into the words of the page; answers do not depend on the fields `ignored`.
   *
   * @param {Design} design
   * @param {{ id: string, words: string, inWords?: (detail: string) => string, ignored?: string[] }} how
   */
  constructor(design, { id, words, inWords = (detail) => detail, ignored = [] }) {
    this.inWords = inWords;
    this.run = h("button", { type: "submit", id: `${id}-run`, className: "primary" }, words);
    this.cancel = button("Cancel", () => this.#cancel(), { hidden: true });
    this.state = h("p", { className: "note", role: "status", id: `${id}-state` });
    this.of = outdated(design, ignored);
  }

  /** @param {string} words */
  say(words) {
    this.state.textContent = words;
  }

  /** @param {string[]} details */
  refuse(...details) {
    this.state.replaceChildren(
      ...details.map((detail) => h("span", { className: "field-error" }, this.inWords(detail), " ")),
    );
  }

  /**
   * Does `work` on a design, which is given what tells how to cancel it; nothing else is asked meanwhile, and a refusal
   * is told.
   *
   * @param {(cancelling: (cancel: () => void) => void) => Promise<void>} work
   * @param {Submission} [submission]
   */
  async ask(work, submission = undefined) {
    this.run.disabled = true;
    this.of.renew(submission);
    try {
      await work((cancel) => {
        this.#cancel = cancel;
        this.cancel.hidden = false;
      });
    } catch (error) {
      if (!(error instanceof ProblemError)) throw error;
      this.refuse(
        ...(error.problem.errors?.length ? error.problem.errors.map(({ detail }) => detail) : [error.message]),
      );
    } finally {
      this.run.disabled = false;
      this.cancel.hidden = true;
    }
  }

  /**
   * Asks for the study that `asked` gives and shows it as its events tell of it: `show` is given what `part` of it
   * tells, once in `pause` milliseconds at most, and its address; `progress` says how far it is of `done` and `total`,
   * and `ended` how it ended.
   *
   * @template F
   * @param {() => Asked} asked
   * @param {Watching<F>} how
   */
  study(asked, how) {
    return this.ask(async (cancelling) => {
      const study = asked();
      const made = await post("v1/studies", study);
      submitted({ id: made.id, kind: kindOf(study), name: study.name ?? "", at: made.submitted_at });
      await this.#watch(made, how, cancelling);
    });
  }

  /**
   * Goes back to a study that was asked for before, of the design `base`.
   *
   * @template F
   * @param {string} id
   * @param {Submission} base
   * @param {Watching<F>} how
   */
  resume(id, base, how) {
    return this.ask(async (cancelling) => this.#watch(await json(`v1/studies/${id}`), how, cancelling), base);
  }

  /**
   * @template F
   * @param {StudyState} made
   * @param {Watching<F>} how
   * @param {(cancel: () => void) => void} cancelling
   */
  async #watch(made, { part = "", pause, progress, show, ended }, cancelling) {
    const address = `v1/studies/${made.id}`;
    const goesOn = !hasEnded(made.status);
    const cancel = () => request(`${address}/cancel`, { method: "POST" }).catch(() => {});
    if (goesOn) cancelling(cancel);
    const work = begin(made.name ?? "", cancel, { id: made.id, seconds: made.estimate?.seconds ?? null });
    const left = remaining();
    let [shown, whole] = [performance.now(), false];
    /** @type {(event: string, data: { done?: number, total?: number }) => void} */
    const told = (event, { done = 0, total }) => {
      if (event === "away") this.say("The service does not answer; it is asked again until it does.");
      if (total) {
        const said = progress(done, total, left);
        this.say(said);
        work.tell({ share: done / total, said });
      }
      if (performance.now() - shown < pause) return;
      shown = performance.now();
      json(address + part).then(
        (found) => whole || show(found, address),
        () => {},
      );
    };
    try {
      const { status } = goesOn ? await follow(address, told) : made;
      const found = await json(address + part);
      whole = true;
      work.end(status);
      show(found, address);
      this.say(ended(found));
    } finally {
      work.end();
    }
  }
}

/**
 * Why most of those failed that did, behind how many: `refusals` are as the service has them, the most common first;
 * `inWords` puts what they say into the words of the page.
 *
 * @type {(refusals: { detail: string }[], inWords: (detail: string) => string) => string}
 */
export const mostOften = ([first], inWords) =>
  first ? `, most often: ${inWords(first.detail).replace(/\.$/, "")}` : "";
