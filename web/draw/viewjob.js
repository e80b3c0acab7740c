// @ts-check
// A job that a view needs: told while it is computed, stopped by a button, and ended with the view and with the page.

import { button, h } from "./dom.js";
import { hasEnded, isAborted, post, ProblemError, request, solved } from "../state/api.js";
import { timeOf } from "../state/numbers.js";
import { begin, tellsOf } from "../state/work.js";

/** @import { Job, NamedDesign } from "../state/documents.js" */
/** @import { Handle } from "../state/work.js" */

/** The job of a view, told in `place`. */
export class ViewJob {
  /**
   * Stops what is asked for; null while nothing is.
   *
   * @type {AbortController | null}
   */
  #asking = null;

  /** @param {HTMLElement} place */
  constructor(place) {
    this.place = place;
  }

  /**
   * What `fetched` gives of a job of the design by the method that it was computed by; null where that was stopped or
   * refused, or nobody waits any more. `what` is computed stands in the words meanwhile.
   *
   * @template T
   * @param {NamedDesign} design
   * @param {string} what
   * @param {(job: Job, signal: AbortSignal) => Promise<T>} fetched
   * @returns {Promise<T | null>}
   */
  async of({ asked, name }, what, fetched) {
    this.end();
    const asking = (this.#asking = new AbortController());
    const work = begin(`${name}, ${what}`, () => asking.abort());
    const hear = tellsOf(work);
    const { signal } = asking;
    const mine = () => this.#asking === asking;
    /** @type {{ id: string, status: string } | undefined} */
    let job;
    /** @type {(event: string, data: any) => void} */
    const told = (event, data) => {
      if (event === "status") job = data;
      hear(event, data);
    };
    const cancel = () => {
      if (job && !hasEnded(job.status))
        request(`v1/jobs/${job.id}/cancel`, { method: "POST", keepalive: true }).catch(() => {});
    };
    // A page that goes away takes along what it has asked for.
    addEventListener("pagehide", cancel);
    const tick = this.#tell(asked, what, asking, work);
    try {
      const found = await fetched(await solved(asked, { told, signal }), signal);
      if (!mine()) return null;
      this.place.replaceChildren();
      return found;
    } catch (error) {
      if (isAborted(error)) cancel();
      else if (!(error instanceof ProblemError)) throw error;
      if (mine()) this.place.replaceChildren(error instanceof ProblemError ? error.reason : "Stopped.");
      return null;
    } finally {
      removeEventListener("pagehide", cancel);
      work.end();
      clearInterval(tick);
      if (mine()) this.#asking = null;
    }
  }

  /** Nobody waits any more. */
  end() {
    const asking = this.#asking;
    this.#asking = null;
    if (asking) this.place.replaceChildren();
    asking?.abort();
  }

  /**
   * Says what is computed and how long that takes, each second, with a button that stops it.
   *
   * @param {NamedDesign["asked"]} asked
   * @param {string} what
   * @param {AbortController} asking
   * @param {Handle} work
   */
  #tell(asked, what, asking, work) {
    const begun = performance.now();
    const words = h("span", {}, `Computing ${what}`);
    this.place.replaceChildren(
      words,
      " ",
      button("Stop", () => asking.abort()),
    );
    let expected = NaN;
    // What is wrong with the design, the job tells.
    post("v1/validate", asked, { signal: asking.signal }).then(
      ({ estimate }) => {
        if (!estimate || !("seconds" in estimate)) return;
        expected = 1000 * estimate.seconds;
        work.tell({ seconds: estimate.seconds });
      },
      () => {},
    );
    return setInterval(() => {
      const left = expected - (performance.now() - begun);
      words.textContent = `Computing ${what}${left > 0 ? `, about ${timeOf(left)} more` : ""}`;
    }, 1000);
  }
}
