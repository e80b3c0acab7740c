// The design that is worked on: a submission, its changes, and the address that carries it.

/** The parts of a JSON pointer. */
export function parts(pointer) {
  return pointer.split("/").slice(1).map((part) => part.replace(/~1/g, "/").replace(/~0/g, "~"));
}

/** What stands at `pointer`; undefined where nothing does. */
export function at(document, pointer) {
  return parts(pointer).reduce((place, part) => (place === null || place === undefined ? undefined : place[part]), document);
}

/** `document` with `value` at `pointer`, objects made on the way; an undefined value takes the field away. */
export function withValue(document, pointer, value) {
  const copy = structuredClone(document);
  const path = parts(pointer);
  const last = path.pop();
  const holder = path.reduce((place, part) => {
    if (place[part] === null || typeof place[part] !== "object") place[part] = {};
    return place[part];
  }, copy);
  if (value !== undefined) holder[last] = value;
  else if (Array.isArray(holder)) holder.splice(Number(last), 1);
  else delete holder[last];
  return copy;
}

/** The submission that is worked on. Its listeners are told what changed it. */
export class Design {
  #listeners = [];

  constructor() {
    this.submission = null;
  }

  onChange(listener) {
    this.#listeners.push(listener);
  }

  /** Takes another submission as a whole; `by` says who does. */
  replace(submission, by) {
    this.submission = structuredClone(submission);
    for (const listener of this.#listeners) listener(by);
  }

  get(pointer) {
    return at(this.submission, pointer);
  }

  set(pointer, value, by) {
    this.setAll({ [pointer]: value }, by);
  }

  /** Several fields at once. */
  setAll(values, by) {
    let next = this.submission;
    for (const [pointer, value] of Object.entries(values)) next = withValue(next, pointer, value);
    this.submission = next;
    for (const listener of this.#listeners) listener(by);
  }
}

async function through(bytes, stream) {
  const packed = new Blob([bytes]).stream().pipeThrough(stream);
  return new Uint8Array(await new Response(packed).arrayBuffer());
}

/** The fragment of an address that carries `submission`. */
export async function toFragment(submission) {
  const packed = await through(new TextEncoder().encode(JSON.stringify(submission)), new CompressionStream("deflate-raw"));
  const text = btoa(String.fromCharCode(...packed));
  return `#design=${text.replace(/\+/g, "-").replace(/\//g, "_").replace(/=+$/, "")}`;
}

/** The submission that an address carries; null if it carries none that can be read. */
export async function fromFragment(fragment) {
  const text = /^#design=([\w-]+)$/.exec(fragment)?.[1];
  if (!text) return null;
  try {
    const packed = Uint8Array.from(atob(text.replace(/-/g, "+").replace(/_/g, "/")), (letter) => letter.charCodeAt(0));
    const submission = JSON.parse(new TextDecoder().decode(await through(packed, new DecompressionStream("deflate-raw"))));
    return submission?.pair ? submission : null;
  } catch {
    return null;
  }
}

/** What a design is called where nobody gave it a name. */
export function nameOf(submission) {
  const hole = (member) => {
    const given = submission.pair?.[member]?.blank?.holes;
    const patterns = given ? [given].flat() : [];
    return patterns.map((each) => `${each.count ?? each.at_deg?.length ?? ""}×${each.radius_mm ? `r${each.radius_mm}` : "slot"}@${each.circle_radius_mm}`).join("+");
  };
  const [driving, driven] = [hole("driving"), hole("driven")];
  const holes = [driving, driven].filter(Boolean).join(" | ") || "no holes";
  return `${submission.pair?.driving?.tooth_count}/${submission.pair?.driven?.tooth_count}, ${holes}`;
}
