// Results while the design changes: one request at a time, always the newest design next.

import { post, ProblemError } from "./api.js";

/** In a mesh period, where a design does not say it. */
const USUAL_POSITIONS = 40;
/** A draft has about so many positions, and at least so many in a mesh period. */
const DRAFT_POSITIONS = 60;
const LEAST_POSITIONS = 10;
/** A hand that rests for so long, in milliseconds, gets all positions. */
const REST = 150;
/** A page that is not seen has no frames; it goes on after so many milliseconds. */
const UNSEEN = 50;

/** The results of `submission` at once. */
export async function preview(submission, signal) {
  const { tags: _, ...asked } = submission;
  return post("v1/preview", asked, { signal });
}

/**
 * Follows a design. While one preview is computed newer designs wait, and only the newest of them is asked for, so that results
 * come in order and a drag shows every result that can be had. Under the hand these are drafts; as soon as it rests it gets the curve
 * itself.
 */
export class Follower {
  #running = false;
  #drawn = "";
  #next = null;
  /** Ends what a newer design need not wait for: a hand's rest, and the curve that follows it. */
  #interrupt = null;
  #settled = Promise.resolve();

  constructor({ onResults, onOutline, onProblem, onBusy }) {
    Object.assign(this, { onResults, onOutline, onProblem, onBusy });
  }

  /** Takes the newest design; `period` is that of its last results, in mesh periods, while a hand changes it. */
  follow(submission, period = null) {
    this.#next = { submission, period, since: performance.now() };
    this.#interrupt?.abort();
    if (!this.#running) this.#settled = this.#run();
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
        await Promise.all([this.#outline(submission), this.#results({ submission, asked: draft ?? submission, since })]);
        // With the next frame comes where the hand is now, and the curve that has just come is painted before the engine wants the cores.
        await frame();
        if (draft && !this.#next) await this.#settle(submission);
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
    await rest(signal);
    if (!signal.aborted) await this.#results({ submission, asked: submission, since: performance.now(), signal });
    this.#interrupt = null;
  }

  /** Holes are drawn from the design itself: an outline is asked for where something else has changed. */
  async #outline(submission) {
    const shape = JSON.stringify(submission.pair, (name, value) => (name === "holes" ? undefined : value));
    if (shape === this.#drawn) return;
    try {
      this.onOutline(await post("v1/outline", submission));
      this.#drawn = shape;
    } catch (error) {
      // The preview of the same submission tells why.
      if (!(error instanceof ProblemError)) throw error;
    }
  }

  async #results({ submission, asked, since, signal }) {
    const begun = performance.now();
    try {
      const results = await preview(asked, signal);
      this.onResults(results, submission, { took: performance.now() - begun, since, draft: asked !== submission });
    } catch (error) {
      if (error.name === "AbortError") return;
      if (!(error instanceof ProblemError)) throw error;
      if (error.problem.code !== "preview_superseded") this.onProblem(error.problem, submission);
    }
  }
}

/**
 * `submission` as it is asked for under a hand: on the coarse grid, whose transmission error is within 0.2 % of that of the standard
 * grid, and at every second or fourth position. What is drawn lies on the curve that follows. Null where that saves nothing.
 */
function draftOf(submission, period) {
  const { positions_per_mesh_period: all = USUAL_POSITIONS, span_mesh_periods: span, grid } = submission.resolution ?? {};
  const periods = (span ?? period) * submission.output_torques_n_m.length;
  const parts = [1, 2, 4].filter((part) => all % part === 0 && all / part >= LEAST_POSITIONS);
  const part = parts.find((each) => (all / each) * periods <= DRAFT_POSITIONS) ?? parts.at(-1) ?? 1;
  if (part === 1 && grid === "coarse") return null;
  return { ...submission, resolution: { ...submission.resolution, positions_per_mesh_period: all / part, grid: "coarse" } };
}

/** The next frame, or a while where nobody looks and none comes. */
function frame() {
  return new Promise((resolve) => {
    requestAnimationFrame(resolve);
    setTimeout(resolve, UNSEEN);
  });
}

function rest(signal) {
  return new Promise((resolve) => {
    const timer = setTimeout(resolve, REST);
    signal.addEventListener("abort", () => { clearTimeout(timer); resolve(); });
  });
}
