// @ts-check
// The state of the page, which named actions change: the design with the way back, what is known of it, the kept design
// that it is compared with, where the gears stand, and the project with its work.

import { Design, nameOf, same } from "./design.js";
import { alike } from "./preview.js";
import { documentOf, MOST_WORK } from "./project.js";
import { onSubmitted } from "./work.js";

/** @import { NamedDesign, Problem, Results, Submission } from "./documents.js" */
/** @import { Content, KeptDesign, RememberedProject } from "./project.js" */
/** @import { Known } from "./projects.js" */
/** @import { Submitted } from "./work.js" */

/**
 * Numbers of another design than the one in the form are gray after so many milliseconds, and what was wrong with
 * another one is told no more.
 */
const OTHER = 300;

/**
 * What is known of the design: `shown`, the results of the design as it is, or those that the hand has passed through;
 * `live`, the last results that are no draft; `problem`, what is wrong with the design as it stands; `computed`, the
 * last design that could be computed.
 *
 * @typedef {{ shown: NamedDesign | null, live: NamedDesign | null,
 *   problem: (Problem & { submission?: Submission }) | null, computed: Submission | null }} Answer
 */

/**
 * The project: where it is kept and the document that was saved there, what was typed of it, its work, the oldest
 * first, and the kept designs that are not computed yet.
 *
 * @typedef {{ known: Known | null, saved: object | null, name: string, notes: string, author: string, drawing: string,
 *   work: Submitted[], waiting: KeptDesign[] }} ProjectState
 */

export class Store {
  design = new Design();
  /** @type {Readonly<Answer>} */
  #answer = { shown: null, live: null, problem: null, computed: null };
  /** @type {Readonly<ProjectState>} */
  #project = { known: null, saved: null, name: "", notes: "", author: "", drawing: "", work: [], waiting: [] };
  /**
   * The kept design that the answers are compared with.
   *
   * @type {NamedDesign | null}
   */
  #against = null;
  #position = 0;
  /**
   * When each design that was worked on was left for another one.
   *
   * @type {WeakMap<Submission, number>}
   */
  #left = new WeakMap();
  /** @type {Submission | null} */
  #worked = null;
  /** @type {(() => void)[]} */
  #onProject = [];

  constructor() {
    const { design } = this;
    design.onChange((by) => {
      if (by !== "kept" && by !== "confirm") this.#leave();
      this.#tellProject();
    });
    onSubmitted((work) => this.#setProject({ work: [...this.#project.work, work].slice(-MOST_WORK) }));
  }

  get answer() {
    return this.#answer;
  }

  /** The design is another one: the time counts from when the one before was left. */
  #leave() {
    const { submission } = this.design;
    if (this.#worked && this.#worked !== submission) this.#left.set(this.#worked, performance.now());
    this.#worked = submission;
    this.#left.delete(submission);
  }

  /**
   * Results have come; those of a draft are shown alone.
   *
   * @param {Results} results
   * @param {Submission} submission
   * @param {{ draft: boolean, asked: Submission }} how
   * @returns {NamedDesign} what is shown
   */
  came(results, submission, { draft, asked }) {
    const { tooth_count: teeth } = submission.pair.driven;
    const shown = { name: nameOf(submission), results, submission, asked, teeth, look: 0 };
    this.#answer = { shown, live: draft ? this.#answer.live : shown, problem: null, computed: submission };
    return shown;
  }

  /**
   * A design was refused.
   *
   * @param {Problem} problem
   * @param {Submission} [submission]
   */
  refuse(problem, submission) {
    this.#answer = { ...this.#answer, problem: { ...problem, submission } };
  }

  /** What was wrong is so no more. */
  pardon() {
    this.#answer = { ...this.#answer, problem: null };
  }

  /** The results of the design as it is; null where there are none. */
  get current() {
    const { live, problem } = this.#answer;
    return live && !problem && same(live.submission, this.design.submission) ? live : null;
  }

  /**
   * What is of another design than the one in the form: what is shown, the last results, and what was wrong; `again` is
   * in how many milliseconds the answer is another one.
   */
  get others() {
    const { shown, live, problem } = this.#answer;
    const { submission: now } = this.design;
    /** @type {(of: Submission | undefined, isIts: (submission: Submission) => boolean) => number | null} */
    const waits = (of, isIts) => {
      if (!of || isIts(of)) return null;
      return Math.max(0, OTHER - (performance.now() - (this.#left.get(of) ?? performance.now())));
    };
    const isLike = (/** @type {Submission} */ submission) => alike(submission, now);
    const all = [
      waits(shown?.submission, isLike),
      waits(live?.submission, isLike),
      waits(problem?.submission, (submission) => submission === now),
    ];
    const next = all.flatMap((wait) => (wait ? [wait] : []));
    return {
      shown: all[0] === 0,
      live: all[1] === 0,
      problem: all[2] === 0,
      again: next.length ? Math.min(...next) : null,
    };
  }

  /** Where the curves and the gears stand, in mesh periods. */
  get position() {
    return this.#position;
  }

  /**
   * The gears stand elsewhere, within their true period.
   *
   * @param {number} to
   */
  turn(to) {
    const period = this.#answer.shown?.results.pair.period_mesh_periods ?? 1;
    this.#position = ((to % period) + period) % period;
  }

  /** The kept design that the answers are compared with: the first until another one is chosen. */
  get against() {
    const { kept } = this.design;
    if (!this.#against || !kept.includes(this.#against)) this.#against = kept[0] ?? null;
    return this.#against;
  }

  /** @param {number} index */
  compareWith(index) {
    this.#against = this.design.kept[index];
  }

  /** The last results and the kept designs. */
  get designs() {
    const { live } = this.#answer;
    return live ? this.besideKept(live) : [];
  }

  /**
   * `one` and the kept designs; it is told from one that is called the same.
   *
   * @param {NamedDesign} one
   */
  besideKept(one) {
    const { kept } = this.design;
    const name = kept.some((each) => each.name === one.name) ? `${one.name} (now)` : one.name;
    return [{ ...one, name }, ...kept];
  }

  /**
   * Keeps a design, under a name and with a look that no other has.
   *
   * @param {Omit<NamedDesign, "look">} entry
   */
  keep(entry) {
    const { kept } = this.design;
    const looks = Array.from({ length: kept.length + 1 }, (_, i) => i + 1);
    const look = looks.find((each) => kept.every((other) => other.look !== each)) ?? 1;
    const names = [entry.name, ...Array.from({ length: 99 }, (_, i) => `${entry.name} (${i + 2})`)];
    const name = names.find((each) => kept.every((other) => other.name !== each)) ?? entry.name;
    this.design.keep([...kept, { ...entry, name, look }]);
  }

  /**
   * Changes a kept design, or takes it away.
   *
   * @param {number} index
   * @param {Partial<NamedDesign> | null} change
   */
  changeKept(index, change) {
    const { kept } = this.design;
    const before = kept[index];
    const next = change && { ...before, ...change };
    if (before === this.#against) this.#against = next;
    this.design.keep(kept.flatMap((each, i) => (i !== index ? [each] : next ? [next] : [])));
  }

  get project() {
    return this.#project;
  }

  /**
   * Calls `listener` when the project is another one, or its document.
   *
   * @param {() => void} listener
   */
  onProject(listener) {
    this.#onProject.push(listener);
  }

  #tellProject() {
    for (const listener of this.#onProject) listener();
  }

  /** @param {Partial<ProjectState>} next */
  #setProject(next) {
    this.#project = { ...this.#project, ...next };
    this.#tellProject();
  }

  /** The document of the project as it is. */
  get document() {
    const { submission, typed, kept } = this.design;
    const { waiting, work, notes, author, drawing } = this.#project;
    return documentOf({ submission, typed, kept: [...kept, ...waiting], work, notes, author, drawing });
  }

  /** True if the project is as it was saved. */
  get isSaved() {
    const { known, name, saved } = this.#project;
    return known?.name === name && same(saved, this.document);
  }

  /**
   * Takes words that somebody has typed of the project.
   *
   * @param {Partial<Pick<ProjectState, "name" | "notes" | "author" | "drawing">>} words
   */
  describe(words) {
    this.#setProject(words);
  }

  /**
   * The project keeps this job or study no more; the service does.
   *
   * @param {string} id
   */
  forget(id) {
    this.#setProject({ work: this.#project.work.filter((each) => each.id !== id) });
  }

  /**
   * The project is kept as `known` since it was saved.
   *
   * @param {Known} known
   * @param {object} saved
   */
  save(known, saved) {
    this.#setProject({ known, saved, name: known.name });
  }

  /** The project is kept nowhere. */
  unsave() {
    this.#setProject({ known: null, saved: null });
  }

  /**
   * Puts a content in place of what is worked on. The way back leads to that.
   *
   * @param {Content} content
   * @param {string} name
   */
  open({ submission, typed, kept: waiting, ...rest }, name) {
    this.#project = { ...this.#project, ...rest, waiting, name };
    this.design.begin({ submission, typed, kept: [] });
  }

  /**
   * A kept design that waited is computed.
   *
   * @param {KeptDesign} design
   */
  arrived(design) {
    this.#setProject({ waiting: this.#project.waiting.filter((each) => each !== design) });
  }

  /** What a reload brings back. */
  get remembered() {
    const { name: _, ...project } = this.#project;
    return { ...this.design.state, project };
  }

  /** @param {RememberedProject} remembered */
  restore({ known, notes, author = "", drawing = "", work = [], waiting, saved }) {
    this.#setProject({ known, saved, name: known?.name ?? "", notes, author, drawing, work, waiting });
  }
}
