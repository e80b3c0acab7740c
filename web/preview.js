// Results while the design changes: one request at a time, always the newest design next.

import { post, ProblemError } from "./api.js";

/** The results of `submission` at once, and of the pair its outline. */
export async function preview(submission, signal) {
  const { tags: _, ...asked } = submission;
  return post("v1/preview", asked, { signal });
}

/**
 * Follows a design. While one preview is computed newer designs wait, and only the newest of them is asked for, so that results
 * come in order and a drag shows every result that can be had.
 */
export class Follower {
  #running = false;
  #drawn = "";
  #next = null;

  constructor({ onResults, onOutline, onProblem, onBusy }) {
    Object.assign(this, { onResults, onOutline, onProblem, onBusy });
  }

  follow(submission) {
    this.#next = { submission, since: performance.now() };
    if (!this.#running) this.#run();
  }

  async #run() {
    this.#running = true;
    this.onBusy(true);
    while (this.#next) {
      const { submission, since } = this.#next;
      this.#next = null;
      await Promise.allSettled([this.#outline(submission), this.#results(submission, since)]);
    }
    this.#running = false;
    this.onBusy(false);
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

  async #results(submission, since) {
    const begun = performance.now();
    try {
      const results = await preview(submission);
      this.onResults(results, submission, { took: performance.now() - begun, since });
    } catch (error) {
      if (!(error instanceof ProblemError)) throw error;
      if (error.problem.code !== "preview_superseded") this.onProblem(error.problem, submission);
    }
  }
}
