// @ts-check
// What is worked on: a submission, the designs that were kept beside it, the way back from every change, and the
// address that carries it.

/** @import { GearName, NamedDesign, Submission } from "./documents.js" */
/** @import { RememberedProject } from "./project.js" */

/**
 * The gears of a pair.
 *
 * @type {GearName[]}
 */
export const MEMBERS = ["driving", "driven"];

/**
 * What changed a design.
 *
 * @typedef {"start" | "open" | "form" | "mend" | "drag" | "snap" | "undo" | "kept" | "confirm"} Cause
 */

/**
 * What a change leads away from, and back to.
 *
 * @typedef {{ submission: Submission, kept: NamedDesign[], typed: Record<string, number> }} State
 */

/** @typedef {State & { past: State[], future: State[], project?: RememberedProject }} Remembered */

/** So many changes can be taken back. */
const MOST_CHANGES = 200;
/** What follows in one field within so many milliseconds is one change. */
const ONE_CHANGE = 1500;

/** The angle that diameters and the center distance go with. */
export const HELIX = "/pair/helix_angle_deg";

/**
 * The parts of a JSON pointer.
 *
 * @type {(pointer: string) => string[]}
 */
export function parts(pointer) {
  return pointer
    .split("/")
    .slice(1)
    .map((part) => part.replace(/~1/g, "/").replace(/~0/g, "~"));
}

/**
 * What stands at `pointer`; undefined where nothing does.
 *
 * @param {unknown} document
 * @param {string} pointer
 * @returns {any} what the schema says of this place, which no type of a pointer can
 */
export function at(document, pointer) {
  return parts(pointer).reduce(
    (/** @type {any} */ place, part) => (place === null || place === undefined ? undefined : place[part]),
    document,
  );
}

/**
 * `document` with `value` at `pointer`, objects made on the way; an undefined value takes the field away.
 *
 * @template T
 * @param {T} document
 * @param {string} pointer
 * @param {unknown} value
 * @returns {T}
 */
export function withValue(document, pointer, value) {
  const copy = structuredClone(document);
  const path = parts(pointer);
  const last = path.pop() ?? "";
  const holder = path.reduce((/** @type {any} */ place, part) => {
    if (place[part] === null || typeof place[part] !== "object") place[part] = {};
    return place[part];
  }, copy);
  if (value !== undefined) holder[last] = value;
  else if (Array.isArray(holder)) holder.splice(Number(last), 1);
  else delete holder[last];
  return copy;
}

/**
 * Whether two submissions are the same.
 *
 * @type {(one: unknown, other: unknown) => boolean}
 */
export function same(one, other) {
  return JSON.stringify(one) === JSON.stringify(other);
}

/**
 * The submission that is worked on and the designs kept beside it. Its listeners are told what changed it: `start`,
 * `open`, `form`, `mend`, `drag` under a hand, `snap` when a hand lets go of what cannot be, `undo`, or `kept` or
 * `confirm` where only the kept designs changed, or what was typed for which angle.
 */
export class Design {
  /** @type {((by: Cause) => void)[]} */
  #listeners = [];
  /** @type {(() => void)[]} */
  #resting = [];
  /** @type {State[]} */
  #past = [];
  /** @type {State[]} */
  #future = [];
  /** @type {{ key: string | symbol | null, time: number }} */
  #last = { key: null, time: 0 };
  /** @type {symbol | null} */
  #hand = null;

  constructor() {
    /**
     * There is none before the page has begun.
     *
     * @type {Submission}
     */
    this.submission = /** @type {any} */ (null);
    /** @type {NamedDesign[]} */
    this.kept = [];
    /**
     * Pointers of the fields that somebody has typed, each with the helix angle that it was typed for.
     *
     * @type {Record<string, number>}
     */
    this.typed = {};
    /** @type {Cause} */
    this.by = "start";
    /** How often the submission has changed. */
    this.changes = 0;
  }

  /**
   * Calls `listener` with what changed the design.
   *
   * @param {(by: Cause) => void} listener
   */
  onChange(listener) {
    this.#listeners.push(listener);
  }

  /**
   * Calls `listener` when a hand lets go.
   *
   * @param {() => void} listener
   */
  onRest(listener) {
    this.#resting.push(listener);
  }

  /** A hand takes hold: all that it changes until [`release`] is one change. */
  hold() {
    this.#hand = Symbol("hand");
  }

  release() {
    this.#hand = null;
    for (const listener of this.#resting) listener();
  }

  /**
   * Takes another submission as a whole.
   *
   * @param {Submission} submission
   * @param {Cause} by
   */
  replace(submission, by) {
    this.#change({ submission: structuredClone(submission), typed: {} }, by, null);
  }

  /**
   * Takes a submission with kept designs and what was typed, as a project has them.
   *
   * @param {State} state
   */
  begin(state) {
    this.#change(structuredClone(state), "open", null);
  }

  /** @param {string} pointer */
  get(pointer) {
    return at(this.submission, pointer);
  }

  /**
   * @param {string} pointer
   * @param {unknown} value
   * @param {Cause} by
   */
  set(pointer, value, by) {
    this.setAll({ [pointer]: value }, by);
  }

  /**
   * Several fields at once; of those that go with what is typed `typed` names those that were.
   *
   * @param {Record<string, unknown>} values
   * @param {Cause} by
   */
  setAll(values, by, typed = Object.keys(values)) {
    let next = this.submission;
    for (const [pointer, value] of Object.entries(values)) next = withValue(next, pointer, value);
    if (same(next, this.submission)) return;
    const others = Object.entries(this.typed).filter(([pointer]) => !(pointer in values));
    const now = by === "form" ? typed.map((pointer) => [pointer, at(next, HELIX) ?? 0]) : [];
    // What is typed is one change until it rests; each press of a button is one by itself.
    const key = by === "mend" ? null : Object.keys(values).join();
    this.#change({ submission: next, typed: Object.fromEntries([...others, ...now]) }, by, this.#hand ?? key);
  }

  /**
   * What was typed at `pointer` is meant for the helix angle as it is.
   *
   * @param {string} pointer
   */
  confirm(pointer) {
    this.#change({ typed: { ...this.typed, [pointer]: this.get(HELIX) ?? 0 } }, "confirm", null);
  }

  /**
   * Goes back to what could be computed, as part of the change that led away from it.
   *
   * @param {Submission} submission
   */
  snapBack(submission) {
    this.#future = [];
    this.submission = submission;
    if (this.#past.length && same(this.#past.at(-1)?.submission, submission)) this.#past.pop();
    this.#last.key = null;
    this.#tell("snap");
  }

  /**
   * Other kept designs.
   *
   * @param {NamedDesign[]} kept
   */
  keep(kept) {
    this.#change({ kept }, "kept", null);
  }

  /** What is worked on and the way back from it, to be remembered. */
  get state() {
    return { ...this.#state(), past: this.#past, future: this.#future };
  }

  /**
   * Begins with what was remembered: `kept` designs, and the way back where it leads from `submission`, which is told
   * as what the page starts with.
   *
   * @param {Submission} submission
   * @param {Remembered} remembered
   */
  restore(submission, { kept, typed, past, future, ...known }) {
    this.kept = kept;
    if (!same(known.submission, submission)) return this.replace(submission, "start");
    this.submission = submission;
    this.typed = typed;
    [this.#past, this.#future] = [past, future];
    return this.#tell("start");
  }

  get canUndo() {
    return this.#past.length > 0;
  }

  get canRedo() {
    return this.#future.length > 0;
  }

  undo() {
    this.#step(this.#past, this.#future);
  }

  redo() {
    this.#step(this.#future, this.#past);
  }

  /**
   * @param {State[]} from
   * @param {State[]} to
   */
  #step(from, to) {
    const state = from.pop();
    if (!state) return;
    to.push(this.#state());
    Object.assign(this, state);
    this.#last.key = null;
    this.#tell("undo");
  }

  /** @returns {State} */
  #state() {
    return { submission: this.submission, kept: this.kept, typed: this.typed };
  }

  /**
   * @param {Partial<State>} next
   * @param {Cause} by
   * @param {string | symbol | null} key
   */
  #change(next, by, key) {
    const now = performance.now();
    const goesOn =
      key !== null && key === this.#last.key && (this.#hand !== null || now - this.#last.time < ONE_CHANGE);
    if (!goesOn && this.submission) this.#past.push(this.#state());
    if (this.#past.length > MOST_CHANGES) this.#past.shift();
    this.#future = [];
    this.#last = { key, time: now };
    Object.assign(this, next);
    this.#tell(by);
  }

  /** @param {Cause} by */
  #tell(by) {
    this.by = by;
    if (!["kept", "confirm"].includes(by)) this.changes += 1;
    for (const listener of this.#listeners) listener(by);
  }
}

/** @type {(bytes: Uint8Array<ArrayBuffer>, stream: GenericTransformStream) => Promise<Uint8Array<ArrayBuffer>>} */
async function through(bytes, stream) {
  const packed = new Blob([bytes]).stream().pipeThrough(stream);
  return new Uint8Array(await new Response(packed).arrayBuffer());
}

/**
 * The fragment of an address that carries `submission`.
 *
 * @type {(submission: Submission) => Promise<string>}
 */
export async function toFragment(submission) {
  const packed = await through(
    new TextEncoder().encode(JSON.stringify(submission)),
    new CompressionStream("deflate-raw"),
  );
  // In pieces: a measured gear of a thousand teeth has more bytes than a function takes arguments.
  let letters = "";
  for (let i = 0; i < packed.length; i += 4096) letters += String.fromCharCode(...packed.subarray(i, i + 4096));
  return `#design=${btoa(letters).replace(/\+/g, "-").replace(/\//g, "_").replace(/=+$/, "")}`;
}

/**
 * The submission that an address carries; null if it carries none that can be read.
 *
 * @type {(fragment: string) => Promise<Submission | null>}
 */
export async function fromFragment(fragment) {
  const text = /^#design=([\w-]+)$/.exec(fragment)?.[1];
  if (!text) return null;
  try {
    const packed = Uint8Array.from(atob(text.replace(/-/g, "+").replace(/_/g, "/")), (letter) => letter.charCodeAt(0));
    const submission = JSON.parse(
      new TextDecoder().decode(await through(packed, new DecompressionStream("deflate-raw"))),
    );
    return submission?.pair ? submission : null;
  } catch {
    return null;
  }
}

/**
 * What a design is called where nobody gave it a name.
 *
 * @type {(submission: Submission) => string}
 */
export function nameOf(submission) {
  /** @type {(member: GearName) => string} */
  const hole = (member) => {
    const given = submission.pair?.[member]?.blank?.holes;
    const patterns = given ? [given].flat() : [];
    return patterns
      .map(
        (each) =>
          `${each.count ?? each.at_deg?.length ?? ""}×${each.radius_mm ? `r${each.radius_mm}` : "slot"}@${each.circle_radius_mm}`,
      )
      .join("+");
  };
  const [driving, driven] = [hole("driving"), hole("driven")];
  const holes = [driving, driven].filter(Boolean).join(" | ") || "no holes";
  return `${submission.pair?.driving?.tooth_count}/${submission.pair?.driven?.tooth_count}, ${holes}`;
}

/**
 * A submission without what goes on from its curves and takes longer than they do, and that.
 *
 * @param {Submission} submission
 * @returns {{ curves: Submission, further: Partial<Submission> }}
 */
export function apart({ force_table, dynamics, stress, face_load, ...curves }) {
  return {
    curves,
    further: Object.fromEntries(
      Object.entries({ force_table, dynamics, stress, face_load }).filter(([, value]) => value !== undefined),
    ),
  };
}

/**
 * The fields in which submissions differ: each pointer with the value of every submission.
 *
 * @type {(submissions: unknown[]) => { pointer: string, values: unknown[] }[]}
 */
export function differences(submissions) {
  const flat = submissions.map((submission) => flattened(/** @type {object} */ (submission)));
  const pointers = [...new Set(flat.flatMap((each) => [...each.keys()]))];
  const rows = pointers.map((pointer) => ({ pointer, values: flat.map((each) => each.get(pointer)) }));
  return rows.filter(({ values }) => values.some((value) => JSON.stringify(value) !== JSON.stringify(values[0])));
}

/**
 * The value of a field in words: of a long list how long it is.
 *
 * @type {(value: unknown) => string}
 */
export function told(value) {
  if (value === undefined) return "not given";
  if (Array.isArray(value)) return value.length > 4 ? `${value.length} numbers` : value.join(", ");
  return String(value).replace(/_/g, " ");
}

/**
 * Every value of a document by its pointer; a list of numbers is one value.
 *
 * @param {object | null | undefined} document
 * @param {string} pointer
 * @param {Map<string, unknown>} found
 */
export function flattened(document, pointer = "", found = new Map()) {
  for (const [name, value] of Object.entries(/** @type {Record<string, unknown>} */ (document ?? {}))) {
    const place = `${pointer}/${name}`;
    if (value !== null && typeof value === "object" && !(Array.isArray(value) && typeof value[0] !== "object"))
      flattened(/** @type {object} */ (value), place, found);
    else if (value !== null && value !== undefined) found.set(place, value);
  }
  return found;
}
