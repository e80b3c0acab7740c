// @ts-check
// How far the computation of the design is: in words, as a clock, and as the progress of a job.

import { byId } from "../draw/dom.js";
import { fixed, number, remaining, timeOf } from "../state/numbers.js";

/** @import { Results } from "../state/documents.js" */
/** @import { Expected, Far, How } from "../state/preview.js" */

/** What takes longer, in milliseconds, is told as a clock. */
const MOMENT = 600;
/** The clock is shown so long after the beginning, in milliseconds. */
const BEGINS = 300;

export class Progress {
  #state = byId("state");
  #bar = byId("progress", HTMLProgressElement);
  #stop = byId("stop");
  /** @type {number | undefined} */
  #expecting;
  /** @type {number | undefined} */
  #following;
  /**
   * The job that is followed, and what says how long the rest of it takes.
   *
   * @type {{ id?: string, left: (done: number, total: number) => string }}
   */
  #job = { left: () => "" };

  /** @param {string} words */
  say(words) {
    this.#state.textContent = words;
  }

  /**
   * How results came.
   *
   * @param {Results} results
   * @param {How} how
   */
  came({ curves }, { took, draft }) {
    clearTimeout(this.#expecting);
    const time =
      took === null ? "as computed before" : took < 2000 ? `in ${fixed(took, 0)} ms` : `in ${fixed(took / 1000, 1)} s`;
    const torque = curves.length > 1 ? `; answers at ${number(curves[0].output_torque_n_m)} N m` : "";
    this.say(`${curves[0].mesh_position.length} positions ${time}${torque}${draft ? ", a draft under the hand" : ""}`);
  }

  /**
   * How long the design takes that is computed now, told as a clock where it is more than a moment.
   *
   * @param {Expected | null} expected
   */
  expect(expected) {
    clearTimeout(this.#expecting);
    if (!expected || 1000 * expected.seconds < MOMENT) return;
    const whole = timeOf(1000 * expected.seconds);
    const what = `Computing, ${expected.method.replace(/_/g, " ")}`;
    const past = () => performance.now() - expected.since;
    const tick = () => {
      if (!this.#bar.hidden) return;
      const over = 1000 * expected.seconds - past();
      this.say(
        expected.rests
          ? `It takes about ${whole}: computed when you rest, or at once with Enter.`
          : over > 0
            ? `${what}, about ${timeOf(over)} more`
            : `${what}, longer than the ${whole} that were expected`,
      );
      this.#expecting = setTimeout(tick, 1000);
    };
    this.#expecting = setTimeout(tick, expected.rests ? 0 : Math.max(0, BEGINS - past()));
  }

  /**
   * How far the job is that computes a design too large for a preview; null: there is none.
   *
   * @param {Far | null} job
   */
  follow(job) {
    clearInterval(this.#following);
    this.#bar.hidden = !job;
    this.#stop.hidden = !job;
    if (!job) return;
    const { id, progress_percent: done = 0, begun, expected, status, away } = job;
    this.#bar.value = done;
    this.#stop.onclick = job.cancel;
    if (this.#job.id !== id) this.#job = { id, left: remaining(expected, () => performance.now() - begun) };
    // Between two events time goes on.
    const tick = () =>
      this.say(
        away
          ? "The service does not answer; a job goes on."
          : status === "accepted"
            ? "A job waits for its turn."
            : done < 100
              ? `A job: ${done} %${this.#job.left(done, 100)}.`
              : "A job: every position is solved, and the results are put together.",
      );
    tick();
    this.#following = setInterval(tick, 1000);
  }
}
