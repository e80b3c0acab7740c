// Results while the design changes: one request at a time, always the newest design next.

import { hasEnded, isPassing, json, post, ProblemError, request, solved } from "./api.js";
import { isSolid } from "./dimensions.js";

/** In a mesh period, where a design does not say it. */
export const USUAL_POSITIONS = 40;
/** A draft has about so many positions, and at least so many in a mesh period. */
const DRAFT_POSITIONS = 60;
const LEAST_POSITIONS = 10;
/** A hand that rests for so long, in milliseconds, gets all positions; one that rests for longer a job, where a preview has too many. */
const REST = 150;
const LONG_REST = 700;
/** What takes longer by the estimate of the service, in seconds, is computed by a job at once, which says how far it is. */
const LONG = 4;
/** Under a hand pairs are projected along their faces: what a hole changes there costs one web. */
const UNDER_A_HAND = "three_dimensional_projected";
/** A page that is not seen has no frames; it goes on after so many milliseconds. */
const UNSEEN = 50;
/** So many designs are not computed again when they come back. */
const KNOWN = 12;

/** What decides the results of a submission: all of it but its tags. */
const untagged = (submission) => JSON.stringify({ ...submission, tags: undefined });

/** The results of `submission` at once. */
export async function preview(submission, signal) {
  const { tags: _, ...asked } = submission;
  return post("v1/preview", asked, { signal });
}

/** The results of `submission`: at once, or of a job where a preview has too many positions. */
export async function resultsOf(submission, options = {}) {
  try {
    return await preview(submission, options.signal);
  } catch (error) {
    if (!isTooLarge(error)) throw error;
    const job = await solved(submission, options);
    return json(`v1/jobs/${job.id}/results`, { signal: options.signal });
  }
}

/** Whether a job may do what a preview does not: it has more positions, and more time. */
const isTooLarge = (error) => error instanceof ProblemError && ["too_large", "time_limit"].includes(error.problem.code);

/**
 * Follows a design. While one preview is computed newer designs wait, and only the newest of them is asked for, so that results
 * come in order and a drag shows every result that can be had. Under the hand these are drafts; as soon as it rests it gets the curve
 * itself, by a job where a preview has too many positions.
 */
export class Follower {
  #running = false;
  #drawn = "";
  #next = null;
  /** Ends what a newer design need not wait for: a hand's rest, and the curve that follows it. */
  #interrupt = null;
  #settled = Promise.resolve();
  #known = new Map();
  /** Asks again for what could not be answered. */
  #again = null;

  constructor({ onResults, onOutline, onProblem, onBusy, onProgress }) {
    Object.assign(this, { onResults, onOutline, onProblem, onBusy, onProgress });
  }

  /** Takes the newest design; `period` is that of its last results, in mesh periods, while a hand changes it. */
  follow(submission, period = null) {
    clearTimeout(this.#again);
    this.#next = { submission, period, since: performance.now() };
    this.#interrupt?.abort();
    if (!this.#running) this.#settled = this.#run();
  }

  /** The results of a submission that has been computed elsewhere. */
  know(submission, results) {
    this.#known.set(untagged(submission), results);
    if (this.#known.size > KNOWN) this.#known.delete(this.#known.keys().next().value);
  }

  /** Waits until what is shown is no draft. */
  settled() {
    return this.#settled;
  }

  async #run() {
    this.#running = true;
    this.onBusy(true);
    try {
      while (this.#next) {
        const { submission, period, since } = this.#next;
        this.#next = null;
        const draft = period === null ? null : draftOf(submission, period);
        const [, computed] = await Promise.all([this.#outline(submission), this.#results({ submission, asked: draft ?? submission, since })]);
        // With the next frame comes where the hand is now, and the curve that has just come is painted before the engine wants the cores.
        await frame();
        if (this.#next || computed === "refused") continue;
        if (draft) await this.#settle(submission);
        else if (computed === "too large") await this.#long(submission, since);
      }
    } finally {
      this.#running = false;
      this.onBusy(false);
    }
  }

  /** Waits for the hand to rest, and gives it the curve itself. */
  async #settle(submission) {
    this.#interrupt = new AbortController();
    const { signal } = this.#interrupt;
    await rest(signal, REST);
    const since = performance.now();
    const computed = signal.aborted ? "" : await this.#results({ submission, asked: submission, since, signal });
    this.#interrupt = null;
    if (computed === "too large" && !this.#next) await this.#long(submission, since);
  }

  /** A job computes what has too many positions for a preview, unless the design changes meanwhile. */
  async #long(submission, since) {
    this.#interrupt = new AbortController();
    const { signal } = this.#interrupt;
    const begun = performance.now();
    let job = null;
    // What it has waited for others tells nothing of how long it takes.
    let computed = null;
    const told = (event, data) => {
      if (event === "status") job = data;
      if (job?.status !== "accepted") computed ??= performance.now();
      this.onProgress({ ...job, ...data, away: event === "away", elapsed: performance.now() - (computed ?? performance.now()), cancel: () => this.#interrupt?.abort() });
    };
    try {
      await rest(signal, LONG_REST);
      if (signal.aborted) return;
      const done = await solved(submission, { told, signal });
      const results = await json(`v1/jobs/${done.id}/results`, { signal });
      this.#show(results, submission, { took: performance.now() - begun, since, draft: false });
    } catch (error) {
      if (error instanceof ProblemError) this.#refused(error, submission);
      else if (error.name !== "AbortError") throw error;
      if (job && !hasEnded(job.status)) request(`v1/jobs/${job.id}/cancel`, { method: "POST" }).catch(() => {});
      if (signal.aborted && !this.#next) this.onProblem({ code: "cancelled", title: "The job was cancelled", detail: "Nothing was computed for this design.", errors: [] }, submission);
    } finally {
      this.#interrupt = null;
      this.onProgress(null);
    }
  }

  /** Holes are drawn from the design itself: an outline is asked for where something else has changed. */
  async #outline(submission) {
    const shape = JSON.stringify(submission.pair, (name, value) => (name === "holes" ? undefined : value));
    if (shape === this.#drawn) return;
    try {
      this.onOutline(await post("v1/outline", submission), submission);
      this.#drawn = shape;
    } catch (error) {
      // The preview of the same submission tells why.
      if (!(error instanceof ProblemError)) throw error;
    }
  }

  /** What became of it: `shown`, `refused`, `too large` for a preview, or `left` for a newer one. */
  async #results({ submission, asked, since, signal }) {
    const begun = performance.now();
    const draft = asked !== submission;
    try {
      const known = this.#known.get(untagged(submission));
      if (!draft && !known && (await isLong(submission, signal))) return "too large";
      const results = (!draft && known) || (await preview(asked, signal));
      this.#show(results, submission, { took: results === known ? null : performance.now() - begun, since, draft });
      return "shown";
    } catch (error) {
      if (error.name === "AbortError") return "left";
      if (!(error instanceof ProblemError)) throw error;
      if (isTooLarge(error)) return "too large";
      if (error.problem.code === "preview_superseded") return "left";
      // What cannot be projected may be computed as it is asked for.
      if (asked.method !== submission.method) return this.#results({ submission, asked: { ...asked, method: submission.method }, since, signal });
      this.#refused(error, submission);
      return "refused";
    }
  }

  /** Says why there are no results. What goes away by itself is waited for, unless the design changes meanwhile. */
  #refused(error, submission) {
    this.onProblem(error.problem, submission);
    if (isPassing(error)) this.#again = setTimeout(() => this.follow(submission), error.after);
  }

  #show(results, submission, how) {
    if (!how.draft) this.know(submission, results);
    this.onResults(results, submission, how);
  }
}

/**
 * `submission` as it is asked for under a hand: without what goes on from its curves, on the coarse grid, whose transmission error is within 0.2 % of that of the standard
 * grid, and at every second or fourth position. What is drawn lies on the curve that follows. Null where that saves nothing.
 */
function draftOf(submission, period) {
  const { positions_per_mesh_period: all = USUAL_POSITIONS, span_mesh_periods: span, grid } = submission.resolution ?? {};
  const periods = (span ?? period) * submission.output_torques_n_m.length;
  const parts = [1, 2, 4].filter((part) => all % part === 0 && all / part >= LEAST_POSITIONS);
  const part = parts.find((each) => (all / each) * periods <= DRAFT_POSITIONS) ?? parts.at(-1) ?? 1;
  const { force_table: table, dynamics, ...asked } = submission;
  if (isSolid(submission.method)) asked.method = UNDER_A_HAND;
  if (asked.method === submission.method && part === 1 && grid === "coarse" && !table && !dynamics) return null;
  return { ...asked, resolution: { ...submission.resolution, positions_per_mesh_period: all / part, grid: "coarse" } };
}

/** Whether the service says that a pair in three dimensions takes long. */
async function isLong(submission, signal) {
  if (!isSolid(submission.method)) return false;
  try {
    return (await post("v1/validate", submission, { signal })).estimate.seconds > LONG;
  } catch (error) {
    // The preview of the same submission tells why.
    if (!(error instanceof ProblemError)) throw error;
    return false;
  }
}

/** The next frame, or a while where nobody looks and none comes. */
function frame() {
  return new Promise((resolve) => {
    requestAnimationFrame(resolve);
    setTimeout(resolve, UNSEEN);
  });
}

function rest(signal, milliseconds) {
  return new Promise((resolve) => {
    const timer = setTimeout(resolve, milliseconds);
    signal.addEventListener("abort", () => { clearTimeout(timer); resolve(); });
  });
}
