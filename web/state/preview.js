// @ts-check
// Results while the design changes: one request at a time, always the newest design next.

import { checked, hasEnded, isAborted, isPassing, json, post, ProblemError, request, solved } from "./api.js";
import { nameOf } from "./design.js";
import { isSolid } from "./dimensions.js";
import { hasMoreThanHoles } from "./openings.js";
import { begin, methodOf, tellsOf } from "./work.js";

/** @import { Cause } from "./design.js" */
/** @import { Job, PairOutline, Problem, Results, Submission } from "./documents.js" */
/** @import { Handle } from "./work.js" */

/** In a mesh period, where a design does not say it. */
export const USUAL_POSITIONS = 40;
/** A draft has about so many positions, and at least so many in a mesh period. */
const DRAFT_POSITIONS = 60;
const LEAST_POSITIONS = 10;
/** A hand that rests for so long, in milliseconds, gets all positions; one that types, or a job, waits for longer. */
const REST = 150;
const LONG_REST = 700;
/**
 * What takes longer by the estimate of the service, in seconds, is not computed at every key, and along faces by the
 * projected method first.
 */
const SHORT = 1;
/** What takes longer, in seconds, is computed by a job at once, which says how far it is. */
const LONG = 4;
/**
 * Pairs along their faces, and their method that solves one mesh period and projects what holes change in the others.
 */
const WHOLE = "three_dimensional";
const PROJECTED = "three_dimensional_projected";
/** The projected method stands for the whole one where it takes at most this part of its time. */
const SAVES = 0.5;
/** A measured time over the estimated one, which further estimates are multiplied by, lies between these. */
const [LEAST_PACE, MOST_PACE] = [0.5, 5];
/** A page that is not seen has no frames; it goes on after so many milliseconds. */
const UNSEEN = 50;
/** So many designs are not computed again when they come back. */
const KNOWN = 12;

/**
 * What decides the results of a submission: all of it but its tags.
 *
 * @type {(submission: Submission) => string}
 */
const untagged = (submission) => JSON.stringify({ ...submission, tags: undefined });

/**
 * Whether two submissions have the same results.
 *
 * @type {(one: Submission, other: Submission) => boolean}
 */
export const alike = (one, other) => one === other || untagged(one) === untagged(other);

/**
 * The results of `submission` at once.
 *
 * @type {(submission: Submission, signal?: AbortSignal) => Promise<Results>}
 */
export async function preview(submission, signal) {
  const { tags: _, ...asked } = submission;
  return post("v1/preview", asked, { signal });
}

/** The problem that stands in place of results where somebody has stopped their computation. */
const CANCELLED = {
  code: "cancelled",
  title: "The job was cancelled",
  detail: "Nothing was computed for this design.",
  errors: [],
};

/**
 * The name of a computation in the list of work.
 *
 * @type {(submission: Submission) => string}
 */
const calledIn = (submission) => `${nameOf(submission)}, ${methodOf(submission)}`;

/**
 * The results of `submission`: at once, or of a job where a preview has too many positions. The list of work has it
 * meanwhile.
 *
 * @type {(submission: Submission) => Promise<Results>}
 */
export async function resultsOf(submission) {
  const asking = new AbortController();
  const { signal } = asking;
  const work = begin(calledIn(submission), () => asking.abort());
  /** @type {Job | null} */
  let job = null;
  const hear = tellsOf(work);
  /** @type {(event: string, data: any) => void} */
  const told = (event, data) => {
    if (event === "status") job = data;
    hear(event, data);
  };
  try {
    return await preview(submission, signal).catch(async (error) => {
      if (!isTooLarge(error)) throw error;
      const { id } = await solved(submission, { told, signal });
      return json(`v1/jobs/${id}/results`, { signal });
    });
  } catch (error) {
    if (!isAborted(error)) throw error;
    cancel(job);
    throw new ProblemError(CANCELLED);
  } finally {
    work.end();
  }
}

/**
 * Cancels a job that goes on.
 *
 * @param {Job | null} job
 */
function cancel(job) {
  if (job && !hasEnded(job.status))
    request(`v1/jobs/${job.id}/cancel`, { method: "POST", keepalive: true }).catch(() => {});
}

/**
 * Whether a job may do what a preview does not: it has more positions, and more time.
 *
 * @type {(error: unknown) => boolean}
 */
const isTooLarge = (error) =>
  error instanceof ProblemError && ["too_large", "time_limit"].includes(error.problem.code ?? "");

/**
 * A design that is followed: what changed it, the period of its last results while a hand moves it, and when it came.
 *
 * @typedef {{ submission: Submission, by: Cause, period: number | null, since: number, drafting?: boolean }} Followed
 */

/** @typedef {{ results: Results, asked: Submission }} Answer */

/**
 * How results came: how long they took, or null where they were known, and since when they were waited for.
 *
 * @typedef {{ took: number | null, since: number, draft: boolean, asked: Submission }} How
 */

/** @typedef {{ seconds: number, since: number, rests: boolean, method: string }} Expected */

/**
 * How far a job is: as the service says it, with when it begun, how long it was expected to take, in milliseconds,
 * whether the service is away, and what cancels it.
 *
 * @typedef {Partial<Job> & { away: boolean, begun: number, expected: number, cancel: () => void }} Far
 */

/**
 * @typedef {object} Hearers
 * @property {(results: Results, submission: Submission, how: How) => void} onResults
 * @property {(outline: PairOutline, submission: Submission) => void} onOutline
 * @property {(problem: Problem, submission: Submission) => void} onProblem
 * @property {(submission: Submission) => void} onValid
 * @property {(expected: Expected | null) => void} onExpect
 * @property {(busy: boolean) => void} onBusy
 * @property {(far: Far | null) => void} onProgress
 */

/**
 * Follows a design. Under a hand one draft is computed at a time and newer designs wait, only the newest of them to be
 * asked for, so that drafts come in order and a drag shows every one that can be had; as soon as the hand rests it gets
 * the curve itself. What else is computed is stopped as soon as there is a newer design. What takes long is computed
 * when the hand rests, or at [`hurry`].
 */
export class Follower {
  #running = false;
  #drawn = "";
  /** @type {Followed | null} */
  #next = null;
  /**
   * What is computed now, as it was given to [`follow`], and whether it is a draft under the hand.
   *
   * @type {Followed | null}
   */
  #now = null;
  /** Ends what a newer design overtakes. */
  #interrupt = new AbortController();
  /**
   * Ends a rest.
   *
   * @type {(() => void) | null}
   */
  #hurry = null;
  /** @type {Promise<void>} */
  #settled = Promise.resolve();
  /**
   * Results by what decides them: `{ results, asked }`, where `asked` is the submission that they are of, which may
   * have the projected method.
   *
   * @type {Map<string, Answer>}
   */
  #known = new Map();
  /**
   * Designs that are wanted by the whole method.
   *
   * @type {Set<string>}
   */
  #whole = new Set();
  /** How much longer than its estimate the last computation took. */
  #pace = 1;
  /**
   * Asks again for what could not be answered.
   *
   * @type {number | undefined}
   */
  #again = undefined;

  /**
   * `onValid` is told that nothing is wrong with a design, and `onExpect` how long the design takes and by which
   * method, or null once that is over.
   *
   * @param {Hearers} hearers
   */
  constructor({ onResults, onOutline, onProblem, onValid, onExpect, onBusy, onProgress }) {
    this.onResults = onResults;
    this.onOutline = onOutline;
    this.onProblem = onProblem;
    this.onValid = onValid;
    this.onExpect = onExpect;
    this.onBusy = onBusy;
    this.onProgress = onProgress;
  }

  /**
   * Takes the newest design and what changed it; `period` is that of its last results, in mesh periods, while a hand
   * changes it.
   *
   * @param {Submission} submission
   * @param {Cause} by
   * @param {number | null} period
   */
  follow(submission, by, period = null) {
    clearTimeout(this.#again);
    const now = { submission, by, period, since: performance.now() };
    this.#next = now;
    if (period === null || !this.#now?.drafting) this.#interrupt.abort();
    if (!this.#running) this.#settled = this.#run();
  }

  /** Computes at once what waits for the hand to rest. */
  hurry() {
    this.#hurry?.();
  }

  /**
   * Computes a design by its own method, where the projected one stands for it.
   *
   * @param {Submission} submission
   */
  whole(submission) {
    this.#whole.add(untagged(submission));
    this.#known.delete(untagged(submission));
    this.follow(submission, "mend");
  }

  /**
   * The results of a submission that has been computed elsewhere; of `asked`, where that is not the submission itself.
   *
   * @param {Submission} submission
   * @param {Results} results
   */
  know(submission, results, asked = submission) {
    this.#known.set(untagged(submission), { results, asked });
    if (this.#known.size <= KNOWN) return;
    const [oldest] = this.#known.keys();
    this.#known.delete(oldest);
  }

  /** Waits until what is shown is no draft. */
  settled() {
    return this.#settled;
  }

  /** @returns {Promise<void>} */
  async #run() {
    this.#running = true;
    this.onBusy(true);
    try {
      while (this.#next) {
        const now = (this.#now = this.#next);
        this.#next = null;
        this.#interrupt = new AbortController();
        const draft = now.period === null ? null : draftOf(now.submission, now.period);
        now.drafting = draft !== null;
        const [, told] = await Promise.all([
          this.#outline(now.submission),
          draft ? this.#ask(now, draft) : this.#compute(now),
        ]);
        now.drafting = false;
        // With the next frame comes where the hand is now, and the curve that has just come is painted before the
        // engine wants the cores.
        await frame();
        if (this.#next || !draft || told === "refused") continue;
        this.#interrupt = new AbortController();
        await this.#rest(REST);
        if (!this.#next) await this.#compute({ ...now, since: performance.now() });
      }
    } finally {
      this.#running = false;
      this.onBusy(false);
    }
  }

  /**
   * Computes a design itself: by a preview, or by a job where that takes long or a preview has too many positions.
   *
   * @param {Followed} now
   * @returns {Promise<void>}
   */
  async #compute(now) {
    const { submission, since } = now;
    const interrupt = this.#interrupt;
    const { signal } = interrupt;
    /** @type {Handle | null} */
    let work = null;
    const known = this.#known.get(untagged(submission));
    if (known) return this.#show(known, submission, { took: null, since, draft: false });
    try {
      const plan = await this.#plan(now, signal);
      if (signal.aborted) return;
      const { asked, seconds } = plan;
      this.onValid(submission);
      const expected = this.#pace * seconds;
      const rests = now.by === "form" && expected > SHORT;
      const { method } = asked;
      this.onExpect({ seconds: expected, since: performance.now(), rests, method });
      if (rests) {
        await this.#rest(LONG_REST - (performance.now() - since));
        if (signal.aborted) return;
        this.onExpect({ seconds: expected, since: performance.now(), rests: false, method });
      }
      work = begin(calledIn(asked), () => interrupt.abort(), { seconds: expected });
      const begun = performance.now();
      const told = seconds > LONG ? "too large" : await this.#ask(now, asked);
      if (told === "too large") await this.#long(now, plan, work);
      else if (told === "shown") this.#learn(performance.now() - begun, seconds);
      // Stopped in the list of work: no newer design has come.
      else if (signal.aborted && !this.#next) this.onProblem(CANCELLED, submission);
    } catch (error) {
      if (error instanceof ProblemError) this.#refused(error, submission);
      else if (!isAborted(error)) throw error;
    } finally {
      work?.end();
      this.onExpect(null);
    }
  }

  /**
   * Remembers how many milliseconds a computation took that had to take so many seconds.
   *
   * @param {number} took
   * @param {number} seconds
   */
  #learn(took, seconds) {
    this.#pace = Math.min(MOST_PACE, Math.max(LEAST_PACE, took / 1000 / seconds));
  }

  /**
   * What is asked for to compute a design, and how long it takes by the estimate of the service. Throws what is wrong
   * with it.
   *
   * @param {Followed} now
   * @param {AbortSignal} signal
   * @returns {Promise<{ asked: Submission, seconds: number }>}
   */
  async #plan({ submission, by }, signal) {
    /** @type {(asked: Submission) => Promise<number>} */
    const secondsOf = async (asked) => (await checked(asked, { signal })).estimate.seconds;
    const seconds = await secondsOf(submission);
    // A design that comes whole, by a link or a file, is computed as it says where nobody has to wait for it.
    const most = ["start", "open"].includes(by) ? LONG : SHORT;
    if (submission.method !== WHOLE || seconds <= most || this.#whole.has(untagged(submission)))
      return { asked: submission, seconds };
    /** @type {Submission} */
    const asked = { ...submission, method: PROJECTED };
    const projected = await secondsOf(asked).catch(() => Infinity);
    return projected <= SAVES * seconds ? { asked, seconds: projected } : { asked: submission, seconds };
  }

  /**
   * A job computes what takes long, unless the design changes meanwhile.
   *
   * @param {Followed} now
   * @param {{ asked: Submission, seconds: number }} plan
   * @param {Handle} work
   */
  async #long({ submission, since }, { asked, seconds }, work) {
    const interrupt = this.#interrupt;
    const { signal } = interrupt;
    const begun = performance.now();
    /** @type {Job | null} */
    let job = null;
    // What it has waited for others tells nothing of how long it takes.
    /** @type {number | null} */
    let computed = null;
    const hear = tellsOf(work);
    /** @type {(event: string, data: any) => void} */
    const told = (event, data) => {
      if (event === "status") job = data;
      hear(event, data);
      if (job?.status !== "accepted") computed ??= performance.now();
      this.onProgress({
        ...job,
        ...data,
        away: event === "away",
        begun: computed ?? performance.now(),
        expected: 1000 * this.#pace * seconds,
        cancel: () => interrupt.abort(),
      });
    };
    // A page that goes away takes along what it has asked for.
    const leave = () => cancel(job);
    addEventListener("pagehide", leave);
    try {
      await this.#rest(LONG_REST - (performance.now() - since));
      if (signal.aborted) return;
      const done = await solved(asked, { told, signal });
      const results = await json(`v1/jobs/${done.id}/results`, { signal });
      if (computed && !done.links.same_as) this.#learn(performance.now() - computed, seconds);
      this.#show({ results, asked }, submission, { took: performance.now() - begun, since, draft: false });
    } catch (error) {
      if (error instanceof ProblemError) this.#refused(error, submission);
      else if (!isAborted(error)) throw error;
      cancel(job);
      if (signal.aborted && !this.#next) this.onProblem(CANCELLED, submission);
    } finally {
      removeEventListener("pagehide", leave);
      this.onProgress(null);
    }
  }

  /**
   * Waits for so many milliseconds, for somebody in a hurry, or for a newer design.
   *
   * @param {number} milliseconds
   * @returns {Promise<void>}
   */
  #rest(milliseconds) {
    const { signal } = this.#interrupt;
    return new Promise((resolve) => {
      const timer = setTimeout(resolve, signal.aborted ? 0 : milliseconds);
      const hurry = () => {
        clearTimeout(timer);
        resolve();
      };
      this.#hurry = hurry;
      signal.addEventListener("abort", hurry);
    });
  }

  /**
   * Holes are drawn from the design itself: an outline is asked for where something else has changed, and at each
   * change of a blank whose other openings it tells behind the holes.
   *
   * @param {Submission} submission
   */
  async #outline(submission) {
    const shape = JSON.stringify(submission.pair, function (/** @type {string} */ name, /** @type {unknown} */ value) {
      return name === "holes" && !hasMoreThanHoles(this) ? undefined : value;
    });
    if (shape === this.#drawn) return;
    try {
      this.onOutline(await post("v1/outline", submission), submission);
      this.#drawn = shape;
    } catch (error) {
      // The preview of the same submission tells why.
      if (!(error instanceof ProblemError)) throw error;
    }
  }

  /**
   * Asks for a preview: what became of it, `shown`, `refused`, `too large` for a preview, or `left` for a newer one.
   *
   * @param {{ submission: Submission, since: number }} now
   * @param {Submission} asked
   * @returns {Promise<string>}
   */
  async #ask({ submission, since }, asked) {
    const begun = performance.now();
    try {
      const results = await preview(asked, this.#interrupt.signal);
      this.#show({ results, asked }, submission, {
        took: performance.now() - begun,
        since,
        draft: this.#now?.drafting === true,
      });
      return "shown";
    } catch (error) {
      if (isAborted(error)) return "left";
      if (!(error instanceof ProblemError)) throw error;
      if (isTooLarge(error)) return "too large";
      if (error.problem.code === "preview_superseded") return "left";
      // What cannot be projected may be computed as it is asked for.
      if (asked.method !== submission.method)
        return this.#ask({ submission, since }, { ...asked, method: submission.method });
      this.#refused(error, submission);
      return "refused";
    }
  }

  /**
   * Says why there are no results. What goes away by itself is waited for, unless the design changes meanwhile.
   *
   * @param {ProblemError} error
   * @param {Submission} submission
   */
  #refused(error, submission) {
    this.onProblem(error.problem, submission);
    if (isPassing(error)) this.#again = setTimeout(() => this.follow(submission, "open"), error.after);
  }

  /**
   * @param {Answer} answer
   * @param {Submission} submission
   * @param {{ took: number | null, since: number, draft: boolean }} how
   */
  #show({ results, asked }, submission, how) {
    if (!how.draft) this.know(submission, results, asked);
    this.onResults(results, submission, { ...how, asked });
  }
}

/**
 * `submission` as it is asked for under a hand: without what goes on from its curves, on the coarse grid, whose
 * transmission error is within 0.2 % of that of the standard grid, and at every second or fourth position. What is
 * drawn lies on the curve that follows. Null where that saves nothing.
 *
 * @type {(submission: Submission, period: number) => Submission | null}
 */
function draftOf(submission, period) {
  const {
    positions_per_mesh_period: all = USUAL_POSITIONS,
    span_mesh_periods: span,
    grid,
  } = submission.resolution ?? {};
  const periods = (span ?? period) * submission.output_torques_n_m.length;
  const parts = [1, 2, 4].filter((part) => all % part === 0 && all / part >= LEAST_POSITIONS);
  const part = parts.find((each) => (all / each) * periods <= DRAFT_POSITIONS) ?? parts.at(-1) ?? 1;
  const { force_table: table, dynamics, ...asked } = submission;
  if (isSolid(submission.method)) {
    // It tells no stresses.
    asked.method = PROJECTED;
    delete asked.stress;
  }
  if (asked.method === submission.method && part === 1 && grid === "coarse" && !table && !dynamics) return null;
  return { ...asked, resolution: { ...submission.resolution, positions_per_mesh_period: all / part, grid: "coarse" } };
}

/**
 * The next frame, or a while where nobody looks and none comes.
 *
 * @type {() => Promise<void>}
 */
function frame() {
  return new Promise((resolve) => {
    requestAnimationFrame(() => resolve());
    setTimeout(resolve, UNSEEN);
  });
}
