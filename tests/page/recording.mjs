// A service of recorded answers: it stands before the real one, which still answers all that takes no time. What the engine
// computes (previews, jobs, studies) is recorded step by step in the folder of RECORDED, and comes from there.
//
// In a recording everything ends at once: where one address gave several answers until the next job or study was asked
// for, the last of them is kept. Numbers are rounded to DIGITS. A request that was not recorded waits until the page
// gives it up, as it does with what a newer design overtakes; a request that is not given up fails the step.

import { createHash } from "node:crypto";
import { existsSync, mkdirSync, readFileSync, readdirSync, rmSync, writeFileSync } from "node:fs";
import { createServer, request as asked } from "node:http";
import { once } from "node:events";
import { join } from "node:path";
import { brotliCompressSync, brotliDecompressSync, constants } from "node:zlib";

const COMPUTED = /^\/v1\/(preview|jobs|studies)\b/;
const TEXT = /json|csv|event-stream/;
/** The headers of an answer that the page or the browser reads. */
const HEADERS = ["content-type", "content-disposition", "location", "retry-after"];
const DIGITS = 6;
/** Numbers with more digits than that; no part of a time or of an identifier. */
const LONG_NUMBER = /(?<![\w:.-])-?\d+\.\d{5,}(?:[eE][-+]?\d+)?(?![\w:])/g;
/** A larger answer, in bytes, is not recorded: its step needs the engine. */
const MOST_BYTES = 2_000_000;
/** So long a request that was not recorded may wait to be given up, in milliseconds. */
const PATIENCE = 15_000;

const hashOf = (bytes) => createHash("sha256").update(bytes).digest("hex").slice(0, 16);

/** Whether a request changes what later ones are answered. */
const changes = (method, path) => method !== "GET" && !path.startsWith("/v1/preview");

/** The answers to one step. */
class Tape {
  /**
   * By what is asked, in order of `after`: how many requests that change something came before.
   *
   * @type {Map<string, { after: number, status: number, headers: Record<string, string>, hash: string }[]>}
   */
  #answers = new Map();
  #folder;
  #file;
  #name;
  #after = 0;
  /** @type {Map<string, number>} */
  #given = new Map();

  constructor(folder, name) {
    this.#folder = folder;
    this.#name = name;
    const words = name.toLowerCase().replace(/[^a-z0-9]+/g, "-");
    this.#file = join(folder, "steps", `${words.slice(0, 60)}-${hashOf(name).slice(0, 4)}.jsonl`);
  }

  /** Reads what was recorded; whether there is any. */
  load() {
    if (!existsSync(this.#file)) return false;
    const [, ...lines] = readFileSync(this.#file, "utf8").trim().split("\n");
    for (const line of lines) {
      const [name, after, status, headers, hash] = JSON.parse(line);
      this.#answers.set(name, [...(this.#answers.get(name) ?? []), { after, status, headers, hash }]);
    }
    return true;
  }

  /** Writes it, and gives the path. */
  save() {
    const lines = [...this.#answers].flatMap(([name, all]) =>
      all.map(({ after, status, headers, hash }) => JSON.stringify([name, after, status, headers, hash])),
    );
    mkdirSync(join(this.#folder, "steps"), { recursive: true });
    writeFileSync(this.#file, `${[JSON.stringify(this.#name), ...lines].join("\n")}\n`);
    return this.#file;
  }

  /** The step begins anew. */
  rewind() {
    this.#after = 0;
    this.#given.clear();
  }

  /** How many requests that change something came before now; one more from now on, if this one does. */
  enter(method, path) {
    const after = this.#after;
    if (changes(method, path)) this.#after += 1;
    return after;
  }

  /** Keeps an answer in place of an earlier one to the same request since something was changed. */
  keep(name, after, { status, headers, body }) {
    const isText = TEXT.test(headers["content-type"] ?? "");
    const bytes = isText ? Buffer.from(rounded(body.toString("utf8"))) : body;
    const hash = hashOf(bytes);
    const place = join(this.#folder, "answers", `${hash}.br`);
    if (!existsSync(place)) {
      mkdirSync(join(this.#folder, "answers"), { recursive: true });
      writeFileSync(place, compressed(bytes));
    }
    const others = (this.#answers.get(name) ?? []).filter((each) => each.after !== after);
    const all = [...others, { after, status, headers, hash }].sort((one, other) => one.after - other.after);
    this.#answers.set(name, all);
  }

  /** The recorded answer to a request now, or null. */
  answer(name, method, path) {
    const all = this.#answers.get(name);
    if (!all) return null;
    let found = all.findLast(({ after }) => after <= this.#after) ?? all[0];
    if (changes(method, path)) {
      const given = this.#given.get(name) ?? 0;
      found = all[Math.min(given, all.length - 1)];
      this.#given.set(name, given + 1);
      this.#after = found.after + 1;
    }
    const body = brotliDecompressSync(readFileSync(join(this.#folder, "answers", `${found.hash}.br`)));
    return { status: found.status, headers: found.headers, body };
  }
}

const rounded = (text) => text.replace(LONG_NUMBER, (digits) => String(Number(Number(digits).toPrecision(DIGITS))));

const compressed = (bytes) =>
  brotliCompressSync(bytes, {
    params: { [constants.BROTLI_PARAM_QUALITY]: 11, [constants.BROTLI_PARAM_SIZE_HINT]: bytes.length },
  });

/** Removes answers that no step has any more; and the steps whose files are not `wanted`, if that is given. */
export function tidy(folder, wanted = null) {
  const steps = readdirSync(join(folder, "steps")).map((name) => join(folder, "steps", name));
  for (const file of steps) if (wanted && !wanted.has(file)) rmSync(file);
  const left = steps.filter((file) => existsSync(file)).map((file) => readFileSync(file, "utf8"));
  const used = new Set(left.flatMap((text) => text.match(/[0-9a-f]{16}(?="\])/g) ?? []));
  for (const name of readdirSync(join(folder, "answers")))
    if (!used.has(name.replace(".br", ""))) rmSync(join(folder, "answers", name));
}

/**
 * A service with recordings before it. `start` starts the real one. It has what a service has, and:
 * - `replay(name)`: from now on the answers of that step are given; a promise that fails once one is missing.
 * - `record(name, work)`: records the step that `work` does, and gives the path of the recording.
 * - `pass()`: from now on the real service answers everything.
 */
export async function recorded(start, folder) {
  let real = await start();
  /** @type {Tape | null} */
  let tape = null;
  /** What becomes of a request: it may be given from the tape, and be kept there. */
  let [gives, keeps] = [false, false];
  let added = 0;
  let tooLarge = "";
  let missed = (_) => {};

  const forward = (request, response, body, kept) => {
    const { method, url } = request;
    const headers = { ...request.headers };
    if (kept) for (const name of ["accept-encoding", "if-none-match"]) delete headers[name];
    const onward = asked(new URL(url, real.url), { method, headers }, (answer) => {
      response.writeHead(answer.statusCode, answer.rawHeaders);
      const chunks = [];
      answer.on("data", (chunk) => chunks.push(chunk));
      answer.on("end", () => kept?.(answer, Buffer.concat(chunks)));
      answer.pipe(response);
    });
    onward.on("error", () => response.destroy());
    response.on("close", () => onward.destroy());
    onward.end(body);
  };

  const wait = (response, what) => {
    const told = missed;
    const timer = setTimeout(() => {
      told(new Error(`not recorded: ${what}`));
      response.destroy();
    }, PATIENCE);
    response.on("close", () => clearTimeout(timer));
  };

  const server = createServer(async (request, response) => {
    const chunks = [];
    for await (const chunk of request) chunks.push(chunk);
    const body = Buffer.concat(chunks);
    const { method, url } = request;
    const now = tape;
    if (!now || !COMPUTED.test(url)) return forward(request, response, body, null);
    const name = `${method} ${url}${body.length ? ` ${hashOf(body)}` : ""}`;
    const found = gives ? now.answer(name, method, url) : null;
    if (found) {
      response.writeHead(found.status, { ...found.headers, "cache-control": "no-store" });
      return response.end(found.body);
    }
    if (!keeps) return wait(response, `${name} ${body.toString("utf8").slice(0, 300)}`);
    const after = now.enter(method, url);
    forward(request, response, body, (answer, all) => {
      added += 1;
      if (all.length > MOST_BYTES) {
        tooLarge = `${method} ${url} is answered by ${all.length} bytes: mark the step with engine`;
        return;
      }
      const headers = Object.fromEntries(
        HEADERS.flatMap((each) => (answer.headers[each] ? [[each, answer.headers[each]]] : [])),
      );
      now.keep(name, after, { status: answer.statusCode, headers, body: all });
    });
  });
  server.requestTimeout = 0;
  await once(server.listen(0, "127.0.0.1"), "listening");
  const { port } = /** @type {import("node:net").AddressInfo} */ (server.address());

  return {
    url: `http://127.0.0.1:${port}/`,
    key: (name) => real.key(name),
    stop: async () => {
      server.closeAllConnections();
      server.close();
      await real.stop();
    },
    pass: () => {
      tape = null;
    },
    replay: (name) => {
      const found = new Tape(folder, name);
      if (!found.load()) return Promise.reject(new Error("there is no recording of this step: tests/page/run record"));
      [tape, gives, keeps] = [found, true, false];
      return new Promise((_, reject) => {
        missed = reject;
      });
    },
    record: async (name, work) => {
      await real.stop();
      real = await start();
      const made = new Tape(folder, name);
      [tape, gives, keeps] = [made, false, true];
      tooLarge = "";
      await work(0);
      // With answers that come at once the page asks for other drafts on the way: they are recorded too.
      gives = true;
      for (let pass = 1; pass <= MOST_PASSES; pass += 1) {
        made.rewind();
        added = 0;
        if (tooLarge) throw new Error(tooLarge);
        await work(pass);
        if (added === 0) return made.save();
      }
      throw new Error(`after ${MOST_PASSES} passes the step still asks for something new`);
    },
  };
}

/** So often a step is repeated until it asks for nothing new. */
const MOST_PASSES = 6;
